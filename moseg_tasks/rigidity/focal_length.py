"""Focal length of a window of frames, by how much of the tracks' motion a rigid scene explains with it."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import fit_pose


def choose_focal(
    points: np.ndarray, visible: np.ndarray, shape: tuple[int, int], params: RigidityParams, step: int = 1
) -> float:
    """Return the one of `params.focals`, in longer sides of the frame, that explains the tracks best.

    The cost of a focal length is the mean over tracks of the squared deviation from the epipolar line, in squares of
    its noise and at most 1. Among those within `params.focal_slack` of the least cost it is the one nearest to
    `params.focal_prior`, which is also the answer where nothing tells them apart.

    Parameters
    ----------
    points : float32 (N, F, 2)
        xy of the tracks, px.
    visible : bool (N, F)
    shape : (height, width)
    params : RigidityParams
    step : int, optional
        Pairs begin at multiples of this.
    """
    num_frames = visible.shape[1]
    gap = min(params.focal_gap, num_frames - 1)
    starts = np.linspace(0, (num_frames - 1 - gap) // step, params.focal_pairs).round().astype(int) * step
    pairs = []
    for start in np.unique(starts) if gap > 0 else ():
        seen = visible[:, start] & visible[:, start + gap]
        pairs.append((points[seen, start].astype(np.float64), points[seen, start + gap].astype(np.float64)))
    return focal_of_pairs(pairs, shape, params)


def focal_of_pairs(
    pairs: Sequence[tuple[np.ndarray, np.ndarray]], shape: tuple[int, int], params: RigidityParams
) -> float:
    """Do the same from the tracks of frame pairs, xy float64 (N, 2) in both frames, px."""
    focals, costs = np.array(params.focals), [np.zeros(len(params.focals))]
    for pair in pairs:
        costs.append(np.array([_cost(*pair, focal, shape, params) for focal in focals]))
    cost = np.sum(costs, axis=0) / max(len(costs) - 1, 1)
    return best_focal(focals, cost, params.focal_prior, params.focal_slack)


def best_focal(focals: np.ndarray, cost: np.ndarray, prior: float, slack: float) -> float:
    """Return the focal length nearest to `prior` among those (K,) within `slack` of the least cost (K,)."""
    good = focals[cost <= cost.min() + slack]
    return float(good[np.argmin(np.abs(np.log(good / prior)))])


def _cost(points0, points1, focal: float, shape: tuple[int, int], params: RigidityParams) -> float:
    """Return the mean cost, 0..1, of a focal length on one pair; 1 without a fit."""
    motion = fit_pose(points0, points1, focal, shape, params)
    if motion is None:
        return 1.0
    across = split_displacements(points0, points1, motion, shape).across
    noise = displacement_noise(points0, points1, params.noise, params.noise_share)
    return float(np.mean(np.minimum((across / noise) ** 2, 1)))
