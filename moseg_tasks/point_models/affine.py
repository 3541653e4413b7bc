"""The affine model: three points, a shallow plane."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike

from moseg.tasks.point_models.blocks import combine_products, sum_of_squares
from moseg.tasks.point_models.correspondences import Correspondences, checked, checked_for_fit
from moseg.tasks.point_models.local_coordinates import local_coordinates

_TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class AffineModel:
    """x1 = A x0 with A float64 (2, 3) on homogeneous pixels.

    Attributes
    ----------
    min_conditioning : float
        Points are collinear if the extent across their best line is below this share of the extent along it. The
        default is a few tenths of a pixel, the accuracy of tracks, over the size of an image.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, section 4.4 (the smallest squared distance in
    both frames together, here also exact because the model is linear).
    """

    min_conditioning: float = 1e-3
    name: str = "affine"
    num_frames: int = 2
    sample_size: int = 3
    needs_depth: bool = False

    def fit(self, data: Correspondences) -> np.ndarray:
        """Return float64 (..., 2, 3) of smallest sum of the squared distances that `residual` measures."""
        data = checked_for_fit(data, self.num_frames, self.needs_depth, self.sample_size)
        points0, points1 = data.points[..., 0, :], data.points[..., 1, :]
        centroid0, centroid1 = points0.mean(axis=-2), points1.mean(axis=-2)
        if data.num_points == self.sample_size:
            linear = _through_three_points(points0, points1)
        else:
            linear = _fit_planes(points0 - centroid0[..., None, :], points1 - centroid1[..., None, :])
        offset = centroid1 - (linear @ centroid0[..., None])[..., 0]
        return np.concatenate([linear, offset[..., None]], axis=-1)

    def residual(self, parameters: np.ndarray, data: Correspondences, dtype: DTypeLike = np.float64) -> np.ndarray:
        """Return the squared distance of (x0, y0, x1, y1) to the plane of the model's pairs, px^2 (..., H, N)."""
        data = checked(data, self.num_frames, self.needs_depth)
        local = local_coordinates(data.points)
        linear, offset = parameters[..., :2], parameters[..., 2]
        centre, scale = local.centre[..., None, :], local.scale[..., None, None]
        offset = ((linear @ centre[..., None])[..., 0] + offset - centre) / scale

        # e = (A - I) x0 + t - (x1 - x0) has the constant derivative J = [A, -I]: the Cholesky factor of JJ' whitens it.
        a = 1 + np.sum(linear[..., 0, :] ** 2, axis=-1)
        b = np.sum(linear[..., 0, :] * linear[..., 1, :], axis=-1)
        c = 1 + np.sum(linear[..., 1, :] ** 2, axis=-1)
        # c - b² / a = (1 + |A|² + det(A)²) / a; the difference is lost to rounding where three points are on a line.
        root_a, root_c = np.sqrt(a), np.sqrt(np.maximum(c - b**2 / a, 1 / a))
        rows = np.zeros((*linear.shape[:-2], 2, 5))
        rows[..., :2] = linear - np.eye(2)
        rows[..., 2] = offset
        rows[..., 0, 3] = rows[..., 1, 4] = -1
        first = rows[..., 0, :] / root_a[..., None]
        second = (rows[..., 1, :] - (b / root_a)[..., None] * first) / root_c[..., None]

        points0, points1 = local.points[..., 0, :], local.points[..., 1, :]
        monomials = np.empty((*points0.shape[:-2], 5, points0.shape[-2]))
        monomials[..., :2, :] = np.swapaxes(points0, -1, -2)
        monomials[..., 2, :] = 1
        monomials[..., 3:, :] = np.swapaxes(points1 - points0, -1, -2)
        to_pixels = local.scale[..., None, None]
        factors = [(first * to_pixels, monomials), (second * to_pixels, monomials)]
        return combine_products(factors, sum_of_squares, 0, dtype)

    def degenerate(self, data: Correspondences) -> np.ndarray:
        """Return whether the points are fewer than three, coincident or collinear in either frame: bool (...)."""
        data = checked(data, self.num_frames, self.needs_depth)
        if data.num_points < self.sample_size:
            return np.ones(data.points.shape[:-3], dtype=bool)
        by_frame = np.swapaxes(data.points, -3, -2)
        extents = np.linalg.svd(by_frame - by_frame.mean(axis=-2, keepdims=True), compute_uv=False)
        # For coincident points, centring leaves rounding of the size of the coordinates.
        size = np.abs(by_frame).max(axis=(-2, -1)) * data.num_points * np.finfo(np.float64).eps
        return (extents[..., 1] <= np.maximum(self.min_conditioning * extents[..., 0], size)).any(axis=-1)


def _through_three_points(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the linear parts (..., 2, 2) of the maps of three points (..., 3, 2) to three others."""
    (a, b), (c, d) = np.moveaxis(points0[..., 1:, :] - points0[..., :1, :], (-2, -1), (0, 1))
    inverse = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    inverse = inverse / _not_zero(a * d - b * c)[..., None, None]
    return np.swapaxes(inverse @ (points1[..., 1:, :] - points1[..., :1, :]), -1, -2)


def _fit_planes(centred0: np.ndarray, centred1: np.ndarray) -> np.ndarray:
    """Return the linear parts (..., 2, 2) whose planes through 0 are nearest to the pairs (x0, x1)."""
    pairs = np.concatenate([centred0, centred1], axis=-1)
    _, vectors = np.linalg.eigh(np.swapaxes(pairs, -1, -2) @ pairs)
    # The two widest directions span the plane: columns (d0, d1) with d1 = A d0.
    (a, b), (c, d) = np.moveaxis(vectors[..., :2, 2:], (-2, -1), (0, 1))
    inverse = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    return vectors[..., 2:, 2:] @ inverse / _not_zero(a * d - b * c)[..., None, None]


def _not_zero(determinant: np.ndarray) -> np.ndarray:
    """Replace 0, the determinant of coincident or collinear points, by 1."""
    return np.where(np.abs(determinant) > _TINY, determinant, 1.0)
