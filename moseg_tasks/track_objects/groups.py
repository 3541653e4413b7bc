"""Motion groups of a balanced sample of the tracks: static ones from the whole frame, and those of the candidates.

Movers own a few percent of the tracks of a road scene, and clustering of all of them cuts the background before it
separates a mover. In the sample they own as much as the background.
"""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import HypothesisParams, TrackGroupParams
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import (
    HypothesisResiduals,
    View,
    cluster_trajectories,
    draw_hypotheses,
    trajectory_kernels,
)


class TrackGroups(NamedTuple):
    """Motion groups of S sampled tracks.

    Attributes
    ----------
    track : int32 (S,)
    is_candidate : bool (S,)
        Whether the track belongs to a candidate; the others are static.
    motion : uint16 (S,)
        Motion group, from 0.
    """

    track: np.ndarray
    is_candidate: np.ndarray
    motion: np.ndarray


def group_tracks(
    points: np.ndarray,
    visible: np.ndarray,
    state: np.ndarray,
    candidate: np.ndarray,
    params: TrackGroupParams,
    rng: np.random.Generator,
) -> TrackGroups:
    """Group a balanced sample of tracks by motion, as trajectories are clustered.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    state : floating (track,)
        Far below 0 where a track is static, as `mean_field` returns it.
    candidate : uint16 (track,)
        0 = none.
    params : TrackGroupParams
    rng : numpy.random.Generator

    Returns
    -------
    TrackGroups
        Empty where too few tracks could be sampled.
    """
    moving = _sample_candidates(visible, candidate, params, rng)
    static = _sample_static(points, visible, (state < params.max_static_state) & (candidate == 0), params, rng)
    if len(moving) < params.min_moving or len(static) < params.min_static:
        return TrackGroups(np.zeros(0, np.int32), np.zeros(0, bool), np.zeros(0, np.uint16))
    tracks = np.concatenate([static, moving])
    seen = visible[tracks]
    place = np.where(seen[..., None], points[tracks], 0).astype(np.float64)
    motion = cluster_trajectories([_views(place, seen, params, rng)], place, seen, None, params.clustering, rng).motion
    return TrackGroups(tracks.astype(np.int32), np.arange(len(tracks)) >= len(static), motion)


def _views(points: np.ndarray, visible: np.ndarray, params: TrackGroupParams, rng: np.random.Generator) -> list[View]:
    """Return the view of each model, from the least general to the most."""
    drawing = HypothesisParams(num_hypotheses=params.num_hypotheses, num_draws=1, gaps=(1,))
    views = []
    for name in (name for name in POINT_MODELS if name in params.models):
        model = POINT_MODELS[name]
        hypotheses = draw_hypotheses(points, visible, model, drawing, rng)
        residuals = HypothesisResiduals(hypotheses, points, visible, model)
        views.append(View(trajectory_kernels(residuals, 1, params.kernel)[0], residuals))
    return views


def _sample_candidates(
    visible: np.ndarray, candidate: np.ndarray, params: TrackGroupParams, rng: np.random.Generator
) -> np.ndarray:
    """Return tracks of the candidates, longer ones more often, and more of a small candidate than its share."""
    life = visible.sum(axis=1)
    tracks = np.flatnonzero((candidate > 0) & (life >= params.min_moving_life))
    if len(tracks) <= params.max_moving:
        return tracks
    weight = life[tracks] / np.sqrt(np.bincount(candidate)[candidate[tracks]])
    return np.sort(rng.choice(tracks, params.max_moving, replace=False, p=weight / weight.sum()))


def _sample_static(
    points: np.ndarray, visible: np.ndarray, is_static: np.ndarray, params: TrackGroupParams, rng: np.random.Generator
) -> np.ndarray:
    """Return static tracks, one of each cell of the frame in which tracks start."""
    tracks = np.flatnonzero(is_static & (visible.sum(axis=1) >= params.min_static_life))
    start = points[tracks, visible[tracks].argmax(axis=1)] // params.cell
    _, first = np.unique(start.astype(np.int64), axis=0, return_index=True)
    tracks = tracks[np.sort(first)]
    if len(tracks) <= params.max_static:
        return tracks
    return np.sort(rng.choice(tracks, params.max_static, replace=False))
