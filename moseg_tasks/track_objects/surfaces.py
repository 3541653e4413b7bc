"""Surfaces of tracks that stand above the ground, each at one depth: parked cars, poles, trunks, walls, and movers."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from moseg.schemas.parameters import RigidityParams, TrackSurfaceParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.ground import Ground
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import Parallax, split_displacements

_CLEAR = 2.0  # standard deviations by which the parallax of a track exceeds that of the ground that it hides
_STANDS = 0.5  # share of its frame pairs in which a track stands above the ground
_MOST = 3.0  # tolerances; a single gross error, where a track slips in a pair, must not part two neighbours
_TINY = 1e-12
"""Smallest tolerance of a difference of inverse depth; avoids division by zero."""


def find_surfaces(
    points: np.ndarray,
    visible: np.ndarray,
    pairs: np.ndarray,
    cameras: Sequence[CameraMotion],
    grounds: Sequence[Ground | None],
    shape: tuple[int, int],
    params: TrackSurfaceParams,
    rigidity: RigidityParams,
) -> np.ndarray:
    """Return the surface that each track belongs to.

    Of the pairs, those of the largest gap are read, where the ground is known. A track stands above the ground if it
    does in half of the pairs that see it. Two neighbours that stand lie on one surface if their inverse depths agree,
    in the mean over the pairs; a surface is a connected component.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    pairs : integer (pair, 2)
        First frame, and frames to the second.
    cameras : sequence of CameraMotion
        Of each pair.
    grounds : sequence of Ground or None
        Seen in each pair.
    shape : (height, width)
        Of the frames, px.
    params : TrackSurfaceParams
    rigidity : RigidityParams
        Of the noise of displacements, and of the parallax that stands above the ground.

    Returns
    -------
    uint16 (track,)
        1.. by falling number of tracks; 0 = none, as all are where no such pair shows the ground.
    """
    num_tracks = len(points)
    stands, num_seen = np.zeros((2, num_tracks))
    edges = [np.zeros((3, 0))]
    widest = pairs[:, 1].max(initial=0)
    for (start, gap), camera, ground in zip(pairs.tolist(), cameras, grounds, strict=True):
        if gap < widest or ground is None:
            continue
        seen = np.flatnonzero(visible[:, start] & visible[:, start + gap])
        points0, points1 = (points[seen, frame].astype(np.float64) for frame in (start, start + gap))
        parallax = split_displacements(points0, points1, camera, shape)
        noise = displacement_noise(points0, points1, rigidity.noise, rigidity.noise_share)
        is_upright = _above_ground(points0, parallax, ground, noise, rigidity)
        stands[seen] += is_upright
        num_seen[seen] += 1
        upright = np.flatnonzero(is_upright)
        edges.append(_compare(points0, upright, parallax, noise, seen, params))
    standing = np.flatnonzero((num_seen > 0) & (stands >= _STANDS * num_seen))
    joined = _agreeing(np.concatenate(edges, axis=1), num_tracks)[standing][:, standing]
    count, component = connected_components(joined, directed=False)
    size = np.bincount(component, minlength=count)
    kept = np.argsort(-size, kind="stable")
    kept = kept[size[kept] >= params.min_tracks]
    kept = kept[: np.iinfo(np.uint16).max]
    number = np.zeros(count, np.uint16)
    number[kept] = np.arange(1, len(kept) + 1)
    surface = np.zeros(num_tracks, np.uint16)
    surface[standing] = number[component]
    return surface


def _above_ground(
    points: np.ndarray, parallax: Parallax, ground: Ground, noise: np.ndarray, rigidity: RigidityParams
) -> np.ndarray:
    """Return which tracks have clearly more parallax than the ground at their pixel, bool (N,)."""
    of_ground = parallax.at(np.maximum(ground.inverse_depth(points), 0))
    clear = parallax.along > rigidity.contact_parallax * of_ground + _CLEAR * noise
    return clear & (parallax.inverse_depth > 0)


def _compare(
    points: np.ndarray,
    upright: np.ndarray,
    parallax: Parallax,
    noise: np.ndarray,
    seen: np.ndarray,
    params: TrackSurfaceParams,
) -> np.ndarray:
    """Return the neighbours among the `upright` ones of the `seen` tracks, and their difference of inverse depth.

    Returns
    -------
    float64 (3, E)
        Two tracks, and the difference in tolerances.
    """
    count = min(params.num_neighbours, len(upright) - 1)
    if count < 1:
        return np.zeros((3, 0))
    distance, near = cKDTree(points[upright]).query(points[upright], k=count + 1)
    is_near = distance[:, 1:].ravel() < params.radius
    own, other = np.repeat(upright, count)[is_near], upright[near[:, 1:].ravel()][is_near]
    inverse_depth, deviation = parallax.inverse_depth, noise / parallax.reach
    largest = np.maximum(inverse_depth[own], inverse_depth[other])
    tolerance = np.maximum(np.hypot(params.agreement * largest, params.noise * deviation[own]), _TINY)
    return np.stack([seen[own], seen[other], np.abs(inverse_depth[own] - inverse_depth[other]) / tolerance])


def _agreeing(edges: np.ndarray, num_tracks: int) -> csr_matrix:
    """Return which neighbours agree in the mean over the pairs in which they are neighbours: bool csr_matrix."""
    rows, columns = np.sort(edges[:2].astype(np.intp), axis=0)
    shape = num_tracks, num_tracks
    difference = coo_matrix((np.minimum(edges[2], _MOST), (rows, columns)), shape).tocsr()
    count = coo_matrix((np.ones(len(rows)), (rows, columns)), shape).tocsr()
    # Both have the same entries in the same order.
    agreeing = csr_matrix((difference.data < count.data, difference.indices, difference.indptr), shape)
    agreeing.eliminate_zeros()
    return agreeing
