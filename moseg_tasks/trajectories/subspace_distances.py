"""Distances of trajectories from the subspaces of motion groups, over many frames."""

import numpy as np

from moseg.schemas.parameters import CodingParams
from moseg.tasks.trajectories.track_windows import TrackWindow, track_windows

_DIRECTIONS = 3
"""Dimensions of a rigid motion's trajectories about their mean under an affine camera."""
_MIN_TRACKS = 8
"""Trajectories of a group that span a window, below which its subspace is not known there."""


def subspace_distances(points: np.ndarray, visible: np.ndarray, labels: np.ndarray, params: CodingParams) -> np.ndarray:
    """Return the distance of each trajectory from the subspace of each group, in units of the group's own.

    In each window of frames the trajectories of a group have a mean and three main directions, as those of a rigid
    motion under an affine camera. The distance is the root mean square over the frames of a window, divided by the
    median over the group or by `params.noise` if that is larger, and it is at least 1: perspective takes the
    trajectories of a deep scene farther from its subspace.

    Parameters
    ----------
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    labels : int (N,)
        Group of each trajectory, 0 .. K - 1, each in use, or -1 for those of no group.
    params : CodingParams
        Windows and noise.

    Returns
    -------
    float64 (N, K)
        1 or more: the geometric mean over the windows that a trajectory spans, NaN if there is none.
    """
    num_groups = int(labels.max()) + 1
    total, count = np.zeros((len(points), num_groups)), np.zeros((len(points), num_groups))
    for window in track_windows(points, visible, params):
        distances = _in_window(window, labels[window.tracks], num_groups, params.noise)
        total[window.tracks] += np.nan_to_num(np.log(distances))
        count[window.tracks] += np.isfinite(distances)
    return np.exp(np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0))


def _in_window(window: TrackWindow, labels: np.ndarray, num_groups: int, noise: float) -> np.ndarray:
    """Return the distances float64 (n, K) of the trajectories of one window, NaN for groups of few in it."""
    rows = window.points.reshape(len(labels), -1)
    distances = np.full((len(rows), num_groups), np.nan)
    for group in range(num_groups):
        own = rows[labels == group]
        if len(own) < _MIN_TRACKS:
            continue
        centred = rows - own.mean(axis=0)
        scatter = centred[labels == group].T @ centred[labels == group]
        basis = np.linalg.eigh(scatter)[1][:, -_DIRECTIONS:]
        left = centred - (centred @ basis) @ basis.T
        size = np.sqrt(np.sum(left**2, axis=1) / window.points.shape[1])
        distances[:, group] = np.maximum(size / max(float(np.median(size[labels == group])), noise), 1.0)
    return distances
