"""Affinity between objects from many hypotheses of motion: alike is what prefers the same hypotheses.

A rank among the objects' own models, as the paper takes it, has no answer for a motion that owns a single object: some
other object's model must come second. Among hundreds of hypotheses of the frame such an object has preferences of its
own, shared by none. No fit to a single object is needed, and no scale in pixels.
"""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.tasks.affinity.preferences import fading_preference_kernel
from moseg.tasks.point_models import Correspondences, PointModel, point_model


def hypothesis_affinity(
    points: np.ndarray,
    visible: np.ndarray,
    owner: np.ndarray,
    num_objects: int,
    params: HypothesisAffinityParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Affinity of each two objects of a clip, by many hypotheses of each of `params.models` in each frame pair.

    Parameters
    ----------
    points : float (N, F, 2)
        xy, px; any value where invisible.
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
        As of ``fused_preferences``.

    Raises
    ------
    InputError
        Where the arrays disagree, an object is out of range, or a model is unknown or not of two frames.
    """
    _check_tracks(points, visible, owner, num_objects)
    models = [_two_view_model(name) for name in params.models]
    sizes = np.bincount(owner, minlength=num_objects)
    # All tracks of an object that has no more: a trajectory that stands for itself takes part.
    least = np.minimum(params.min_tracks, np.maximum(sizes, 1))
    gap = max(min(params.gap, points.shape[1] - 1), 1)
    residuals = np.full((len(models), max(points.shape[1] - gap, 0), params.num_hypotheses, num_objects), np.nan)
    for frame in range(residuals.shape[1]):
        frames = [frame, frame + gap]
        seen = visible[:, frames].all(axis=1)
        tracks = Correspondences(points[seen][:, frames].astype(np.float64))
        for index, model in enumerate(models):
            residuals[index, frame] = object_residuals(tracks, owner[seen], least, model, params, rng)
    return fused_preferences(residuals, params)


def object_residuals(
    tracks: Correspondences,
    owner: np.ndarray,
    min_tracks: np.ndarray,
    model: PointModel,
    params: HypothesisAffinityParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Median squared distance of each object's tracks to models of minimal samples from a few objects each.

    Parameters
    ----------
    tracks : Correspondences
        N tracks seen in both frames of a pair.
    owner : integer (N,)
        Object of each.
    min_tracks : int (K,)
        Fewer tracks of an object say nothing of it.
    model : PointModel
    params : HypothesisAffinityParams
        `num_hypotheses` and `num_objects` are read.
    rng : numpy.random.Generator

    Returns
    -------
    float64 (num_hypotheses, K)
        px²; NaN for objects with too few tracks, and for all where the frames share fewer than a sample takes.
    """
    residual = np.full((params.num_hypotheses, len(min_tracks)), np.nan)
    if tracks.num_points < model.sample_size:
        return residual
    samples = draw_object_samples(owner, model.sample_size, params.num_hypotheses, params.num_objects, rng)
    # In single precision: only the order of distances is used, and what overflows is as far as can be.
    with np.errstate(over="ignore"):
        squared = model.residual(model.fit(tracks.take(samples)), tracks, np.float32)
    for index, least in enumerate(min_tracks):
        own = owner == index
        if own.sum() >= least:
            residual[:, index] = np.median(squared[:, own], axis=1)
    return residual


def draw_object_samples(
    owner: np.ndarray, sample_size: int, num_samples: int, num_objects: int, rng: np.random.Generator
) -> np.ndarray:
    """Tracks of random minimal samples, each from the union of a few random objects.

    A sample of the whole frame is of one motion with the motion's share of the tracks to the power of the sample size:
    where the background shows few of them, never. A sample of one object is of one motion but says nothing of what
    lies beyond it. A few objects are often of one motion and always of several places.

    Parameters
    ----------
    owner : integer (N,)
        Object of each track.
    sample_size : int
        At most N.
    num_samples : int
    num_objects : int
        Objects that a sample is drawn from, all equally likely; inside their union so are all tracks. Where these are
        too few, the rest of the sample is of the other objects.
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
    """Affinity of objects by the hypotheses that they prefer, of several models as one.

    Models err in opposite ways. A fundamental matrix explains two objects of which one moves along the epipolar lines
    of the other; a homography tears a deep background apart. Their product wants both to agree. The power makes small
    affinities smaller, so that the mean affinity between groups, which clustering goes by, is that of their nearest
    parts rather than of all: parts of one motion at opposite ends of the frame need not be alike.

    Parameters
    ----------
    residuals : sequence of float (M, H, K)
        For each model [pair, hypothesis, object], px²; NaN where an object is absent.
    params : HypothesisAffinityParams
        `window`, `fade`, `fusion` and `power` are read.

    Returns
    -------
    float64 (K, K)
        In 0..1, symmetric, 1 on the diagonal; NaN where two objects were never seen together: missing is not zero.
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
