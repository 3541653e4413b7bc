"""Separation of motion groups into objects that do not touch."""

import math

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.distance import cdist, pdist, squareform

from moseg.schemas.parameters import SeparationParams

_MAX_FRAMES = 60
"""Frames of a trajectory, on average, in which distances are measured; in a long clip, they are spaced out evenly."""


def separate_objects(
    points: np.ndarray,
    visible: np.ndarray,
    labels: np.ndarray,
    params: SeparationParams,
    neighbours: csr_array | None = None,
) -> np.ndarray:
    """Split each group except the background into parts that are not connected in the image.

    Two cars on parallel lanes obey one fundamental matrix: their geometry does not show that they are two. A moving
    object is one connected body, so parts of a group with other trajectories or empty image between them are two
    objects. The roof and the wheels of a bus have no trajectories between them either, but they are nearer to each
    other than each is long. The group with the largest convex hull is the background and is not split.

    Parameters
    ----------
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    labels : int (N,)
        0 .. K - 1.
    params : SeparationParams
        Two trajectories touch if one is among the `num_neighbours` nearest of the other, by their mean distance in the
        frames that show both. Parts of fewer than `min_tracks`, and parts that are nearer to the others than
        `min_gap` times the diagonal of the smaller, stay with the largest part.
    neighbours : sparse (N, N), optional
        `nearest_trajectories` of these points, if they are known already.

    Returns
    -------
    int64 (N,)
        Labels 0 .. K' - 1, K' >= K.
    """
    if not labels.any():
        return labels.astype(np.int64)
    if neighbours is None:
        neighbours = nearest_trajectories(points, visible, params.num_neighbours)
    background = max(np.unique(labels), key=lambda label: _hull_area(points[labels == label], visible[labels == label]))
    separated, count = labels.astype(np.int64), int(labels.max()) + 1
    for label in np.unique(labels):
        if label == background:
            continue
        own = np.flatnonzero(labels == label)
        _, part = connected_components(neighbours[own][:, own], directed=False)
        sizes = np.bincount(part)
        for other in np.flatnonzero(sizes >= params.min_tracks):
            inside, outside = own[part == other], own[part != other]
            if other != np.argmax(sizes) and _relative_gap(points, visible, inside, outside) >= params.min_gap:
                separated[inside] = count
                count += 1
    return separated


def _relative_gap(points: np.ndarray, visible: np.ndarray, first: np.ndarray, second: np.ndarray) -> float:
    """Return the distance of two sets of trajectories by the diagonal of the smaller; infinite if never seen together.

    The distance is that of their nearest points, and both are medians over the frames that show two trajectories of
    each.
    """
    gaps, diagonals = [], []
    for frame in _sampled_frames(visible):
        seen = [points[own[visible[own, frame]], frame] for own in (first, second)]
        if min(map(len, seen)) >= 2:
            gaps.append(cdist(*seen).min())
            diagonals.append([np.linalg.norm(np.ptp(place, axis=0)) for place in seen])
    return float(np.median(gaps) / max(np.median(diagonals, axis=0).min(), 1.0)) if gaps else np.inf


def _sampled_frames(visible: np.ndarray) -> range:
    """Return the frames in which distances are measured."""
    mean = np.count_nonzero(visible) / max(len(visible), 1)
    return range(0, visible.shape[1], max(1, math.ceil(mean / _MAX_FRAMES)))


def nearest_trajectories(points: np.ndarray, visible: np.ndarray, count: int) -> csr_array:
    """Return whether j is among the nearest trajectories of i, by their mean distance: sparse (N, N)."""
    num = len(points)
    distance = _mean_distances(points, visible)
    np.fill_diagonal(distance, np.inf)
    count = min(count, num - 1)
    nearest = np.argpartition(distance, count - 1, axis=1)[:, :count] if count else np.zeros((num, 0), int)
    rows = np.repeat(np.arange(num), count)
    is_known = np.isfinite(np.take_along_axis(distance, nearest, axis=1)).ravel()
    pairs = rows[is_known], nearest.ravel()[is_known]
    return csr_array((np.ones(len(pairs[0]), dtype=np.int8), pairs), shape=(num, num))


def _mean_distances(points: np.ndarray, visible: np.ndarray) -> np.ndarray:
    """Return the mean distance of trajectories in the frames that show both, px: float32 (N, N), infinite if none."""
    frames = _sampled_frames(visible)
    if visible.all():
        # Half as many distances, and no indices.
        total = np.zeros(len(points) * (len(points) - 1) // 2, np.float32)
        for frame in frames:
            total += pdist(points[:, frame])
        return squareform(total / np.float32(len(frames)), checks=False)
    total, together = np.zeros((2, len(points), len(points)), np.float32)
    for frame in frames:
        seen = np.flatnonzero(visible[:, frame])
        both = np.ix_(seen, seen)
        total[both] += cdist(points[seen, frame], points[seen, frame])
        together[both] += 1
    return np.divide(total, together, out=np.full_like(total, np.inf), where=together > 0)


def _hull_area(points: np.ndarray, visible: np.ndarray) -> float:
    """Return the area of the convex hull of the visible points, px²; 0 for points on a line."""
    try:
        return float(ConvexHull(points[visible]).volume)
    except (QhullError, ValueError):
        return 0.0
