"""The fundamental matrix: eight points, a rigid scene and a moving camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike

from moseg.tasks.geometry.coordinates import hartley_transform
from moseg.tasks.geometry.eight_point import SAMPLE_SIZE, eight_point, epipolar_equations
from moseg.tasks.geometry.sampson import (
    gradient_coefficients,
    gradient_monomials,
    quadratic_coefficients,
    quadratic_monomials,
)
from moseg.tasks.point_models.blocks import combine_products
from moseg.tasks.point_models.correspondences import Correspondences, checked, checked_for_fit
from moseg.tasks.point_models.local_coordinates import local_coordinates


@dataclass(frozen=True)
class FundamentalModel:
    """x1' F x0 = 0 with F float64 (3, 3) of unit Frobenius norm on homogeneous pixels.

    Attributes
    ----------
    rank_two : bool
        Whether F is brought to rank 2, the rank for two cameras. A minimal model then no longer fits its own sample:
        between near frames with noisy points, the smallest change to rank 2 exceeds the noise. Without it, x1' F x0 = 0
        is a general bilinear relation, exact on eight points: a better hypothesis, but not a better estimate.
    min_conditioning : float
        Smallest ratio of the eighth to the first singular value of the Hartley-normalised epipolar equations for
        points that determine it. Planes, cameras without a translation, collinear and repeated points are below it.
    """

    rank_two: bool = True
    min_conditioning: float = 1e-4
    name: str = "fundamental"
    num_frames: int = 2
    sample_size: int = SAMPLE_SIZE
    needs_depth: bool = False

    def fit(self, data: Correspondences) -> np.ndarray:
        """Return float64 (..., 3, 3) by the eight-point algorithm, with or without its last step."""
        data = checked_for_fit(data, self.num_frames, self.needs_depth, self.sample_size)
        points0, points1 = data.points[..., 0, :], data.points[..., 1, :]
        return eight_point(points0, points1, self.rank_two)

    def residual(self, parameters: np.ndarray, data: Correspondences, dtype: DTypeLike = np.float64) -> np.ndarray:
        """Return the squared Sampson distance, px^2 (..., H, N), by products for the error and its squared gradient.

        With x0 = m - u/2 and x1 = m + u/2, x1' F x0 = m'Sm - u'Su/4 + u'Km for the symmetric and the skew part S, K of
        F. Between near frames S and u are small, so the sum is accurate for small errors in single precision.

        References
        ----------
        R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, eq. 11.9.
        """
        local = local_coordinates(checked(data, self.num_frames, self.needs_depth).points)
        to_pixels = local.to_pixels()
        F = np.swapaxes(to_pixels, -1, -2) @ parameters @ to_pixels
        F = F / np.linalg.norm(F, axis=(-2, -1), keepdims=True)
        points0, points1 = local.points[..., 0, :], local.points[..., 1, :]
        factors = [
            (_error_coefficients(F), _error_monomials(points0, points1)),
            (gradient_coefficients(F), gradient_monomials(points0, points1)),
        ]
        squared = combine_products(factors, _squared_over_gradient, 0, dtype)
        squared *= local.squared_scale().astype(dtype)
        return squared

    def degenerate(self, data: Correspondences) -> np.ndarray:
        """Return whether more than one fundamental matrix fits the points: bool (...)."""
        data = checked(data, self.num_frames, self.needs_depth)
        if data.num_points < self.sample_size:
            return np.ones(data.points.shape[:-3], dtype=bool)
        normalised = [hartley_transform(data.points[..., frame, :])[0] for frame in (0, 1)]
        singular = np.linalg.svd(epipolar_equations(*normalised), compute_uv=False)
        return singular[..., 7] < self.min_conditioning * singular[..., 0]


def _squared_over_gradient(products: np.ndarray, squared: np.ndarray) -> None:
    error, gradient = products
    # At an epipole both vanish, the numerator faster; the gradient is then rounding of the sum.
    np.maximum(gradient, np.finfo(squared.dtype).eps, out=gradient)
    error *= error
    np.divide(error, gradient, out=squared)


def _error_coefficients(F: np.ndarray) -> np.ndarray:
    """Return x1' F x0 as coefficients (..., 9) of `_error_monomials`: the entries of S, then of K."""
    S, K = (F + np.swapaxes(F, -1, -2)) / 2, (F - np.swapaxes(F, -1, -2)) / 2
    return np.concatenate([quadratic_coefficients(S), K[..., [0, 0, 1], [1, 2, 2]]], axis=-1)


def _error_monomials(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the monomials (..., 9, N) of mm' - uu'/4, then of u x m."""
    middle, u = (points0 + points1) / 2, points1 - points0
    half = u / 2
    monomials = np.empty((*u.shape[:-2], 9, u.shape[-2]))
    monomials[..., :6, :] = quadratic_monomials(middle)
    monomials[..., 0, :] -= half[..., 0] ** 2
    monomials[..., 1, :] -= half[..., 0] * half[..., 1]
    monomials[..., 3, :] -= half[..., 1] ** 2
    monomials[..., 6, :] = u[..., 0] * middle[..., 1] - u[..., 1] * middle[..., 0]
    monomials[..., 7:, :] = np.swapaxes(u, -1, -2)
    return monomials
