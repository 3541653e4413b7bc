"""Coordinates of about unit size for a whole point set, the same in all its frames.

Residuals are computed in them: one scale for all frames keeps distances comparable between frames, and one origin keeps
displacements small relative to positions, so that products in single precision are accurate.
"""

from typing import NamedTuple

import numpy as np


class LocalCoordinates(NamedTuple):
    """Points in local coordinates, with pixel = scale local + centre.

    Attributes
    ----------
    points : float64 (..., N, F, 2)
    centre : float64 (..., 2)
        Mean over points and frames, px.
    scale : float64 (...)
        Root mean square of the coordinates about it, px; 1 if all points coincide.
    """

    points: np.ndarray
    centre: np.ndarray
    scale: np.ndarray

    def to_pixels(self) -> np.ndarray:
        """Return the matrix M, float64 (..., 1, 3, 3), with pixel = M local in homogeneous coordinates."""
        return _affine_matrices(self.scale, self.centre)

    def from_pixels(self) -> np.ndarray:
        """Return the inverse of `to_pixels`."""
        return _affine_matrices(1 / self.scale, -self.centre / self.scale[..., None])

    def squared_scale(self) -> np.ndarray:
        """Return the factor from squared local distances to px^2, float64 (..., 1, 1)."""
        return self.scale[..., None, None] ** 2


def local_coordinates(points: np.ndarray) -> LocalCoordinates:
    """Return local coordinates of each point set of float64 (..., N, F, 2), px."""
    if points.shape[-3] == 0:
        return LocalCoordinates(points, np.zeros((*points.shape[:-3], 2)), np.ones(points.shape[:-3]))
    centre = points.mean(axis=(-3, -2))
    centred = points - centre[..., None, None, :]
    scale = np.sqrt(np.mean(centred**2, axis=(-3, -2, -1)))
    scale = np.where(scale > 0, scale, 1.0)
    return LocalCoordinates(centred / scale[..., None, None, None], centre, scale)


def _affine_matrices(scale: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Return the matrices (..., 1, 3, 3) of x -> scale x + offset; the added dimension broadcasts over models."""
    matrices = np.zeros((*scale.shape, 1, 3, 3))
    matrices[..., 0, 0, 0] = matrices[..., 0, 1, 1] = scale
    matrices[..., 0, :2, 2] = offset
    matrices[..., 0, 2, 2] = 1
    return matrices
