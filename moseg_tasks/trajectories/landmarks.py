"""Landmarks: the trajectories that are clustered when there are too many for a full affinity matrix."""

from collections.abc import Sequence

import numpy as np

from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals, preferences

_CELL_BITS = 6
"""The image is divided into 64 x 64 cells to order trajectories by place."""


def choose_landmarks(points: np.ndarray, visible: np.ndarray, count: int) -> np.ndarray:
    """Choose trajectories evenly over the image, the longest of each place.

    Parameters
    ----------
    points : floating (N, frame, xy)
        px.
    visible : bool (N, frame)
    count : int

    Returns
    -------
    int64 (min(N, count),)
        Ascending; all trajectories if there are no more than `count`.
    """
    num_tracks = len(points)
    if num_tracks <= count:
        return np.arange(num_tracks)
    length = visible.sum(axis=1)
    place = (points * visible[..., None]).sum(axis=1) / np.maximum(length, 1)[:, None]
    order = np.argsort(_curve_position(place), kind="stable")
    # Neighbours on a curve through all cells form equal shares, and each gives one landmark.
    share = np.empty(num_tracks, np.int64)
    share[order] = np.arange(num_tracks) * count // num_tracks
    by_share = np.lexsort((-length, share))
    first = np.searchsorted(share[by_share], np.arange(count))
    return np.sort(by_share[first])


def assign_motions(
    landmarks: np.ndarray, motion: np.ndarray, residuals: Sequence[HypothesisResiduals], window: float
) -> np.ndarray:
    """Assign each trajectory to the group of landmarks whose preferences are most like its own.

    A group prefers a hypothesis as much as the share of its landmarks that do. The likeness is the cosine between the
    preferences over the sets that show the trajectory, summed over the models; time and memory are linear in the
    number of trajectories. Cosines are comparable between a small group and a large one with many preferences.

    Parameters
    ----------
    landmarks : int (M,)
    motion : int (M,)
        0 .. K - 1, each in use.
    residuals : sequence of HypothesisResiduals
        Of all N trajectories, for each model.
    window : float
        Share of a set's hypotheses that a trajectory prefers.

    Returns
    -------
    int64 (N,)
        That of `motion` for landmarks. A trajectory without any likeness joins the largest group.
    """
    num_motions, num_tracks = int(motion.max()) + 1, residuals[0].is_seen.shape[1]
    group = np.full(num_tracks, -1)
    group[landmarks] = motion
    likeness = np.zeros((num_tracks, num_motions))
    for each in residuals:
        shared, squares = np.zeros((2, num_tracks, num_motions))
        count = max(1, round(window * each.num_hypotheses))
        for index in range(len(each.is_seen)):
            seen, codes = each.of_set(index)
            preferred = preferences(codes, count).astype(np.float32)
            members = (group[seen, None] == np.arange(num_motions)).astype(np.float32)
            profile = members.T @ preferred / np.maximum(members.sum(axis=0), 1)[:, None]
            shared[seen] += preferred @ profile.T
            squares[seen] += (profile**2).sum(axis=1)
        likeness += shared / np.sqrt(np.maximum(squares, np.finfo(np.float64).tiny))
    assigned = np.where(likeness.any(axis=1), likeness.argmax(axis=1), np.bincount(motion).argmax())
    assigned[landmarks] = motion
    return assigned


def _curve_position(place: np.ndarray) -> np.ndarray:
    """Return the position of points (N, xy) on the Z-order curve through the cells: int64 (N,)."""
    low, high = place.min(axis=0), place.max(axis=0)
    cells = 1 << _CELL_BITS
    cell = np.minimum((place - low) / np.maximum(high - low, 1e-9) * cells, cells - 1).astype(np.int64)
    position = np.zeros(len(place), np.int64)
    for bit in range(_CELL_BITS):
        position |= ((cell[:, 0] >> bit) & 1) << (2 * bit) | ((cell[:, 1] >> bit) & 1) << (2 * bit + 1)
    return position
