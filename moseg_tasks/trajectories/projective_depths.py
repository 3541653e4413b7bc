"""Projective depths of trajectories: factors by which a rigid motion under perspective spans four dimensions only."""

import numpy as np
from scipy.linalg.lapack import dgeqrf, dorgqr

MIN_TRACKS = 8
"""Trajectories below which depths are not estimated: a group of fewer is flat enough or fits anything."""
_RANK = 4
_MOMENTUM = 0.7
"""Share of the last step that is added to the depths before each projection; ten rounds then do what thirty do."""
_FARTHEST = 10.0
"""Largest ratio of a depth to the mean, and of the mean to a depth."""


def projective_depths(points: np.ndarray, num_rounds: int) -> np.ndarray:
    """Estimate the depths for which points times depths have four dimensions.

    A point (x, y) of frame t is the projection of a point X of space, ``depth (x, y, 1) = P_t X``: for the right depths
    the homogeneous coordinates of all frames have rank 4. Each round projects them onto the nearest matrix of rank 4
    and takes the depths from it. The first depths are 1, an affine camera: weak perspective needs few rounds.

    Parameters
    ----------
    points : float (N, frame, xy)
        px, about the mean of all.
    num_rounds : int

    Returns
    -------
    float64 (N, frame)
        Mean 1 in each frame and, nearly, of each trajectory.

    References
    ----------
    P. Sturm and B. Triggs, "A factorization based algorithm for multi-image projective structure and motion", ECCV
    1996; R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, section 18.4.
    """
    num, num_frames = points.shape[:2]
    scale = float(np.sqrt(np.mean(points**2))) or 1.0
    x, y = np.moveaxis(points / scale, 2, 0)
    # Frames of x, then of y, then of 1: blocks of columns are faster than interleaved coordinates.
    rows = np.concatenate([x, y, np.ones_like(x)], axis=1)
    squared = x**2 + y**2 + 1
    depths = previous = np.ones((num, num_frames))
    basis = np.zeros((0, 0))
    for _ in range(num_rounds):
        ahead = depths + _MOMENTUM * (depths - previous)
        scaled = (rows.reshape(num, 3, num_frames) * ahead[:, None]).reshape(rows.shape)
        basis = _leading_vectors(scaled.T @ scaled, basis)
        product = (scaled @ basis) @ basis.T
        product *= rows
        ratio = product[:, :num_frames] + product[:, num_frames : 2 * num_frames] + product[:, 2 * num_frames :]
        ratio /= squared
        previous, depths = depths, _balance(np.clip(ratio, 1 / _FARTHEST, _FARTHEST))
    return depths


def _leading_vectors(scatter: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return the four leading eigenvectors; in later rounds by power iterations from those of the round before."""
    if not before.size:
        return np.linalg.eigh(scatter)[1][:, -_RANK:]
    # What `numpy.linalg.qr` calls, whose own work takes several times as long on so few numbers.
    factors, reflectors, _, _ = dgeqrf(scatter @ (scatter @ before))
    return dorgqr(factors, reflectors, overwrite_a=True)[0]


def _balance(depths: np.ndarray) -> np.ndarray:
    """Scale depths to mean 1 over the frames and over the trajectories: the scale of each is not determined."""
    # Products with a vector are faster than means of short rows.
    over_tracks, over_frames = (np.full(count, 1 / count) for count in depths.shape)
    depths = depths / (depths @ over_frames)[:, None]
    depths /= over_tracks @ depths
    depths /= (depths @ over_frames)[:, None]
    return depths
