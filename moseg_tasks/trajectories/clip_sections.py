"""Motion groups of clips much longer than their trajectories: sections of the clip are grouped, and linked."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from moseg.schemas.parameters import ClipSectionParams, TrajectoryClusteringParams
from moseg.tasks.clustering.spectral import embed_views
from moseg.tasks.trajectories.candidates import in_order
from moseg.tasks.trajectories.cluster import TrajectoryClustering
from moseg.tasks.trajectories.group_trajectories import ModelKernels, TrajectoryGroups, group_trajectories
from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals
from moseg.tasks.trajectories.landmarks import assign_motions, choose_landmarks
from moseg.tasks.trajectories.trajectory_hypotheses import Hypotheses


class _Section(NamedTuple):
    """Data of `group_trajectories` for some frames of a clip."""

    landmarks: np.ndarray
    """int (n,): those of the clip's M landmarks that are seen in the section."""
    points: np.ndarray
    visible: np.ndarray
    views: list[ModelKernels]


def group_clip(
    points: np.ndarray,
    visible: np.ndarray,
    is_stray: np.ndarray,
    views: Sequence[ModelKernels],
    num_motions: int | None,
    params: TrajectoryClusteringParams,
    section_params: ClipSectionParams,
    window: float,
    rng: np.random.Generator,
) -> TrajectoryGroups:
    """Group all trajectories of a clip by motion, in one part or, if it is long, in sections.

    Few affinities connect trajectories of different times, so that the best cut of a long clip is one in time. Sections
    of a few trajectories' length are therefore grouped one by one. They overlap by half, so that most trajectories lie
    within two of them, and groups of the next section become the motions with which they share most trajectories. All
    sections have the same number of motions: a motion that some of them do not show may be found elsewhere there. If
    the number is not given, it is the most frequent of the numbers found. Time is linear in the number of sections.

    Parameters
    ----------
    points : float64 (N, frame, xy)
        px.
    visible : bool (N, frame)
    is_stray : bool (N,)
        Trajectories that join the groups of the others; the published methods cluster them too.
    views : sequence of ModelKernels
        From the least general model to the most; kernels are those of `choose_landmarks`.
    num_motions : int, optional
        None: it is found.
    params : TrajectoryClusteringParams
    section_params : ClipSectionParams
    window : float
        Share of a set's hypotheses that a trajectory prefers.
    rng : numpy.random.Generator
    """
    all_landmarks = choose_landmarks(points, visible, views[0].kernels.shape[1])
    follows = np.arange(len(all_landmarks))
    if params.method == "energy" and not is_stray[all_landmarks].all():
        follows = np.flatnonzero(~is_stray[all_landmarks])
    landmarks = all_landmarks[follows]
    own_views = [view._replace(codes=None).of_landmarks(follows) for view in views]
    own_points, own_visible = points[landmarks], visible[landmarks]
    spans = _spans(own_visible, section_params)
    found = [_section(own_points, own_visible, own_views, frames, section_params.min_visible) for frames in spans]
    sections = [section for section in found if section is not None]

    if len(sections) < 2:
        whole = own_views
        if params.method == "energy":
            everything = points[all_landmarks], visible[all_landmarks]
            whole = [view.with_codes(*everything).of_landmarks(follows) for view in views]
        sections = [_Section(np.arange(len(landmarks)), own_points, own_visible, whole)]

    def group(section: _Section, count: int | None) -> TrajectoryGroups:
        return group_trajectories(section.points, section.visible, section.views, count, params, window, rng)

    found = _with_one_number(sections, num_motions, group)
    motion, clustering = found[0].motion, found[0].clustering
    if len(sections) > 1:
        votes = _link(sections, [each.motion for each in found], len(landmarks))
        # Trajectories of a few frames are in no section.
        is_grouped = votes.any(axis=1)
        landmarks, motion = landmarks[is_grouped], in_order(votes[is_grouped].argmax(axis=1))
        linked = [view._replace(kernels=view.kernels[:, is_grouped][:, :, is_grouped]) for view in own_views]
        clustering = _summary(linked, [each.clustering for each in found], motion)
    if len(landmarks) < len(points):
        everything = [HypothesisResiduals(view.hypotheses, points, visible, view.model) for view in views]
        motion = assign_motions(landmarks, motion, everything, window)
    num_outliers = sum(each.num_outliers for each in found) + len(all_landmarks) - len(follows)
    return TrajectoryGroups(motion.astype(np.uint16), clustering, num_outliers)


def _spans(visible: np.ndarray, params: ClipSectionParams) -> list[slice]:
    """Return the frames of the sections; none if the clip is not much longer than its trajectories."""
    num_frames = visible.shape[1]
    usual = float(np.median(visible.sum(axis=1))) if len(visible) else 0.0
    length = max(int(params.length * usual), params.min_frames)
    if num_frames <= params.max_length * usual or num_frames <= length:
        return []
    starts = [*range(0, num_frames - length, length // 2), num_frames - length]
    return [slice(start, start + length) for start in starts]


def _section(
    points: np.ndarray, visible: np.ndarray, views: Sequence[ModelKernels], frames: slice, min_visible: int
) -> _Section | None:
    """Return the data of a section; None if a model has no hypotheses there or nothing is seen."""
    own = np.flatnonzero(visible[:, frames].sum(axis=1) >= min_visible)
    parts = []
    for view in views:
        inside = ((view.hypotheses.frames >= frames.start) & (view.hypotheses.frames < frames.stop)).all(axis=1)
        drawn = Hypotheses(view.hypotheses.parameters[inside], view.hypotheses.frames[inside] - frames.start)
        parts.append(view._replace(hypotheses=drawn).of_landmarks(own))
    if not len(own) or not all(len(part.hypotheses.frames) for part in parts):
        return None
    return _Section(own, points[own, frames], visible[own, frames], parts)


def _with_one_number(
    sections: Sequence[_Section], num_motions: int | None, group: Callable[[_Section, int | None], TrajectoryGroups]
) -> list[TrajectoryGroups]:
    """Return groups of the sections, of the given number or of the one that most sections have."""
    found = [group(section, num_motions) for section in sections]
    if num_motions is not None:
        return found
    counts = Counter(each.clustering.num_motions for each in found)
    number = max(counts, key=lambda count: (counts[count], -count))
    return [
        each if each.clustering.num_motions == number else group(section, number)
        for section, each in zip(sections, found, strict=True)
    ]


def _link(sections: Sequence[_Section], motions: Sequence[np.ndarray], num_landmarks: int) -> np.ndarray:
    """Return in how many frames of the sections each landmark is in each motion: int (M, K).

    The groups of a section are matched one-to-one with the motions of the sections before it.
    """
    votes = np.zeros((num_landmarks, max(int(motion.max()) + 1 for motion in motions)), np.int64)
    for section, motion in zip(sections, motions, strict=True):
        lengths = section.visible.sum(axis=1)
        groups = np.zeros((len(motion), votes.shape[1]), np.int64)
        groups[np.arange(len(motion)), motion] = lengths
        shared = groups.T @ votes[section.landmarks]
        _, matched = linear_sum_assignment(shared, maximize=True)
        inverse = np.argsort(matched)
        votes[section.landmarks] += groups[:, inverse]
    return votes


def _summary(
    views: Sequence[ModelKernels], found: Sequence[TrajectoryClustering], motion: np.ndarray
) -> TrajectoryClustering:
    """Return the clustering of the landmarks: costs are means over the sections."""
    num_motions = int(motion.max()) + 1
    mean = np.mean([view.kernels.mean(axis=0) for view in views], axis=0, dtype=np.float64)
    embedding = embed_views(mean[None], num_motions)
    terms = []
    for name in ("costs", "cuts", "codes"):
        of_sections = [getattr(each, name)[:num_motions] for each in found]
        padded = [np.pad(each, (0, num_motions - len(each)), constant_values=np.nan) for each in of_sections]
        known = np.isfinite(padded)
        total = np.where(known, padded, 0).sum(axis=0)
        terms.append(np.divide(total, known.sum(axis=0), out=np.full(num_motions, np.nan), where=known.any(axis=0)))
    return TrajectoryClustering(
        motion.astype(np.uint16), embedding.coordinates, embedding.eigenvalues, embedding.objective, *terms, num_motions
    )
