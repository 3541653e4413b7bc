"""Reasons why points in three frames do not determine a trifocal tensor, or only one of collinear cameras."""

from enum import IntEnum

import numpy as np

from moseg.tasks.geometry.coordinates import hartley_transform
from moseg.tasks.point_models.trifocal_tensor import SAMPLE_SIZE, epipoles, trifocal_tensor, trilinear_equations


class TrifocalDegeneracy(IntEnum):
    """Reason code of a point set: the first that applies, in this order."""

    NONE = 0
    """The points determine the tensor, and the three camera centres are not collinear."""
    TOO_FEW_POINTS = 1
    """Fewer than seven points."""
    ILL_CONDITIONED = 2
    """The trilinear equations have more than one solution: a plane, a camera that only rotates from the first frame to
    another, collinear or coincident points."""
    COLLINEAR_CENTRES = 3
    """The three camera centres lie on a line, or the last two coincide: the tensor is determined, but epipolar lines
    alone do not transfer points of the trifocal plane."""


def find_degeneracies(points: np.ndarray, min_conditioning: float, min_centre_angle: float) -> np.ndarray:
    """Return the `TrifocalDegeneracy` of each point set of float64 (..., N, 3, 2): uint8 (...)."""
    lead = points.shape[:-3]
    if points.shape[-3] < SAMPLE_SIZE:
        return np.full(lead, TrifocalDegeneracy.TOO_FEW_POINTS, dtype=np.uint8)
    normalised = np.stack([hartley_transform(points[..., frame, :])[0] for frame in range(3)], axis=-2)
    singular = np.linalg.svd(trilinear_equations(normalised), compute_uv=False)
    reason = np.full(lead, TrifocalDegeneracy.NONE, dtype=np.uint8)
    reason[centre_angle(trifocal_tensor(normalised)) < min_centre_angle] = TrifocalDegeneracy.COLLINEAR_CENTRES
    reason[singular[..., 25] < min_conditioning * singular[..., 0]] = TrifocalDegeneracy.ILL_CONDITIONED
    return reason


def centre_angle(T: np.ndarray) -> np.ndarray:
    """Return the sine of the angle between the images of the first and the third camera centre in the second frame.

    Parameters
    ----------
    T : float64 (..., 3, 3, 3)
        Tensors in coordinates of unit size.

    Returns
    -------
    sine : float64 (...)
        0 if the three centres are collinear, and small if the last two are close to each other.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, algorithm 15.1 (cameras from the tensor).
    """
    epipole1, epipole2 = epipoles(T)
    # The cameras are [I 0], [a e'] and [b e''] with b orthogonal to e'', so the third centre is (X, 0) with b X = 0.
    a = np.swapaxes((T @ epipole2[..., None, :, None])[..., 0], -1, -2)
    columns = np.swapaxes((epipole1[..., None, None, :] @ T)[..., 0, :], -1, -2)
    b = epipole2[..., :, None] * (epipole2[..., None, :] @ columns) - columns
    X = np.linalg.svd(b).Vh[..., 2, :]
    seen = (a @ X[..., None])[..., 0]
    length = np.linalg.norm(seen, axis=-1)
    size = np.linalg.norm(a, axis=(-2, -1))
    length, size = (np.maximum(value, np.finfo(np.float64).tiny) for value in (length, size))
    sine = np.linalg.norm(np.cross(epipole1, seen), axis=-1) / length
    # The image of a centre that coincides with the camera's own is the zero vector.
    return np.minimum(sine, length / size)
