"""Affinity between objects from many motion hypotheses: objects that prefer the same hypotheses are alike.

A rank among the objects' own models, as in the paper, is not defined for a motion with a single object: some other
object's model must come second. Among hundreds of hypotheses of the frame such an object prefers some that no other
object prefers. No fit to a single object and no scale in pixels is needed.
"""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.tasks.affinity.preferences import fading_preference_kernel
from moseg.tasks.point_models import Correspondences, PointModel, point_model, sample_residuals


def hypothesis_affinity(
    points: np.ndarray,
    visible: np.ndarray,
    owner: np.ndarray,
    num_objects: int,
    params: HypothesisAffinityParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the affinity of each two objects of a clip, by many hypotheses of `params.models` in each frame pair.

    Parameters
    ----------
    points : float (N, F, 2)
        xy, px; any value if invisible.
    visible : bool (N, F)
    owner : integer (N,)
        Object of each track, below `num_objects`; each track may be an object of its own.
    num_objects : int
        K.
    params : HypothesisAffinityParams
    rng : numpy.random.Generator

    Returns
    -------
    float64 (K, K)
        See ``fused_preferences``.

    Raises
    ------
    InputError
        If the arrays disagree, an object is out of range, or a model is unknown or not of two frames.
    """
    _check_tracks(points, visible, owner, num_objects)
    models = [_two_view_model(name) for name in params.models]
    sizes = np.bincount(owner, minlength=num_objects)
    # Not more than an object has, so that single trajectories are objects too.
    min_tracks = np.minimum(params.min_tracks, np.maximum(sizes, 1))
    gap = max(min(params.gap, points.shape[1] - 1), 1)
    residuals = np.full((len(models), max(points.shape[1] - gap, 0), params.num_hypotheses, num_objects), np.nan)
    for frame in range(residuals.shape[1]):
        frames = [frame, frame + gap]
        seen = visible[:, frames].all(axis=1)
        tracks, seen_owner = Correspondences(points[seen][:, frames].astype(np.float64)), owner[seen]
        for index, model in enumerate(models):
            if tracks.num_points >= model.sample_size:
                samples = draw_object_samples(
                    seen_owner, model.sample_size, params.num_hypotheses, params.num_objects, rng
                )
                residuals[index, frame] = sample_residuals(tracks, seen_owner, min_tracks, model, samples)
    return fused_preferences(residuals, params)


def draw_object_samples(
    owner: np.ndarray, sample_size: int, num_samples: int, num_objects: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw tracks of random minimal samples, each from the union of a few random objects.

    The probability that a sample of the whole frame has one motion is the motion's share of the tracks to the power of
    the sample size: with few background tracks it is close to 0. A sample of one object has one motion, but its model
    is not determined outside the object. A few objects often share one motion and always cover several places.

    Parameters
    ----------
    owner : integer (N,)
        Object of each track.
    sample_size : int
        At most N.
    num_samples : int
    num_objects : int
        Number of objects that a sample is drawn from, all equally likely; so are all tracks of their union. If these
        are too few, the rest of the sample is of the other objects.
    rng : numpy.random.Generator

    Returns
    -------
    intp (num_samples, sample_size)
        Without repetition inside a sample.
    """
    _, inverse = np.unique(owner, return_inverse=True)
    place = np.argsort(rng.random((num_samples, inverse.max() + 1)), axis=1)
    is_outside = (place >= num_objects)[:, inverse]
    keys = rng.random((num_samples, len(owner))) + is_outside
    return np.argpartition(keys, sample_size - 1, axis=1)[:, :sample_size]


def fused_preferences(residuals: Sequence[np.ndarray], params: HypothesisAffinityParams) -> np.ndarray:
    """Return the affinity of objects by the hypotheses that they prefer, fused over several models.

    Models have opposite errors. A fundamental matrix explains two objects of which one moves along the epipolar lines
    of the other; homographies differ within a deep background. Their product requires both to agree. The power reduces
    small affinities, so that the mean affinity between groups, which the clustering uses, depends mostly on their most
    similar parts: parts of one motion at opposite ends of the frame need not be alike.

    Parameters
    ----------
    residuals : sequence of float (M, H, K)
        For each model [pair, hypothesis, object], px²; NaN if an object is absent.
    params : HypothesisAffinityParams
        `window`, `fade`, `fusion` and `power` are read.

    Returns
    -------
    float64 (K, K)
        In 0..1, symmetric, 1 on the diagonal; NaN, not 0, for two objects never visible together.
    """
    kernels = np.stack([fading_preference_kernel(residual, params.window, params.fade) for residual in residuals])
    known = np.isfinite(kernels)
    count = known.sum(axis=0)
    if params.fusion == "product":
        fused = np.where(known, kernels, 1.0).prod(axis=0) ** (1.0 / np.maximum(count, 1))
    else:
        fused = np.where(known, kernels, 0.0).sum(axis=0) / np.maximum(count, 1)
    return np.where(count > 0, fused**params.power, np.nan)


def _two_view_model(name: str) -> PointModel:
    model = point_model(name)
    if model.num_frames != 2 or model.needs_depth:
        raise InputError("model cannot be fitted to the tracks of two frames", where="affinity", got=name)
    return model


def _check_tracks(points: np.ndarray, visible: np.ndarray, owner: np.ndarray, num_objects: int) -> None:
    if points.ndim != 3 or points.shape[2] != 2 or visible.shape != points.shape[:2] or owner.shape != points.shape[:1]:
        got = f"points {points.shape}, visible {visible.shape}, owner {owner.shape}"
        raise InputError("tracks disagree in shape", where="affinity", got=got, expected="(N, F, 2), (N, F), (N,)")
    if len(owner) and not 0 <= owner.min() <= owner.max() < num_objects:
        raise InputError("object out of range", where="owner", got=owner.max(), expected=f"0 .. {num_objects - 1}")
