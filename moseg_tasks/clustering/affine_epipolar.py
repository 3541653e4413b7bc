"""Affine epipolar geometry of a few points, the model of small and distant objects."""

import numpy as np

from moseg.tasks.geometry.ransac import draw_samples

MIN_POINTS = 5
"""An affine epipolar geometry fits four point pairs exactly."""
_SAMPLE_SIZE = 4
_NUM_REFITS = 3  # the weights change little after the second


def affine_epipolar_distances(
    points0: np.ndarray, points1: np.ndarray, *, threshold: float, num_samples: int, rng: np.random.Generator
) -> np.ndarray | None:
    """Return the distance of each point pair to the affine fundamental matrix that explains most of them, px.

    The pairs (x0, y0, x1, y1) of one motion under an affine camera lie on a hyperplane; a pair's distance to it is its
    Sampson distance. The plane of the best of `num_samples` minimal samples is refined by reweighted least squares.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        xy, px.
    threshold : float
        Scale of the robust loss, px.
    num_samples : int
    rng : numpy.random.Generator

    Returns
    -------
    float64 (N,) or None
        None for fewer than five points.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, algorithm 14.1 and section 14.3.
    """
    joint = np.concatenate([points0, points1], axis=1)
    if len(joint) < MIN_POINTS:
        return None
    samples = joint[draw_samples(len(joint), _SAMPLE_SIZE, num_samples, rng)]
    centres = samples.mean(axis=1)
    normals = np.linalg.svd(samples - centres[:, None])[2][:, -1]
    distances = np.abs(normals @ joint.T - np.sum(normals * centres, axis=1)[:, None])
    distance = distances[np.argmin(np.minimum(distances, threshold) ** 2 @ np.ones(len(joint)))]
    for _ in range(_NUM_REFITS):
        # Weight of the Geman-McClure loss.
        weight = (1.0 + (distance / threshold) ** 2) ** -2
        centred = joint - weight @ joint / weight.sum()
        distance = np.abs(centred @ np.linalg.eigh((centred.T * weight) @ centred)[1][:, 0])
    return distance
