"""The trifocal tensor: seven points, a rigid scene in three frames of a moving camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike

from moseg.tasks.point_models.blocks import combine_products
from moseg.tasks.point_models.correspondences import Correspondences, checked, checked_for_fit
from moseg.tasks.point_models.local_coordinates import local_coordinates
from moseg.tasks.point_models.trifocal_degeneracy import TrifocalDegeneracy, find_degeneracies
from moseg.tasks.point_models.trifocal_tensor import SAMPLE_SIZE, transform_tensor, trifocal_tensor

_TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class TrifocalModel:
    """sum_i x0^i [x1]x T[i] [x2]x = 0 with T float64 (3, 3, 3) of unit norm on homogeneous pixels.

    Attributes
    ----------
    min_conditioning : float
        Smallest ratio of the 26th to the first singular value of the Hartley-normalised trilinear equations for points
        that determine the tensor. Planes, a first camera without a translation to one of the others, collinear and
        repeated points are below it.
    min_centre_angle : float
        Sine of the angle between the images of the two other camera centres in the middle frame, as homogeneous
        vectors in Hartley-normalised coordinates, below which the three centres are collinear.
    accept_collinear_centres : bool
        Whether a sample with collinear camera centres is accepted. It determines the tensor and the residuals here,
        which use all trilinearities; only the transfer by intersecting epipolar lines fails. A camera that drives
        straight ahead is always close to this case.
    """

    min_conditioning: float = 1e-5
    min_centre_angle: float = 1e-2
    accept_collinear_centres: bool = False
    name: str = "trifocal"
    num_frames: int = 3
    sample_size: int = SAMPLE_SIZE
    needs_depth: bool = False

    def fit(self, data: Correspondences) -> np.ndarray:
        """Return float64 (..., 3, 3, 3), a tensor of three cameras."""
        data = checked_for_fit(data, self.num_frames, self.needs_depth, self.sample_size)
        return trifocal_tensor(data.points)

    def residual(self, parameters: np.ndarray, data: Correspondences, dtype: DTypeLike = np.float64) -> np.ndarray:
        """Return the squared Sampson distance of (x0, x1, x2) to the triples that obey the tensor, px^2 (..., H, N).

        The triples are a variety of dimension three in six coordinates, so of the four trilinearities of axis-parallel
        lines three are independent to first order. With M = sum_i x0^i T[i] and E the 2 x 2 errors, dE_ab/dx1_a = p_b
        and dE_ab/dx2_b = q_a: the combination E_ab q'_a p'_b, q' and p' orthogonal to q and p, does not depend on x1 or
        x2 nor, on the variety, on x0. The distance of the other three is e' (D + GG')^-1 e with a diagonal D and their
        derivative G by x0, which the Woodbury identity reduces to 2 x 2 systems.

        The errors cancel too far for single precision: the computation is in double, the result of `dtype`.

        References
        ----------
        R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, sections 4.2.6 and 16.6.
        """
        data = checked(data, self.num_frames, self.needs_depth)
        local = local_coordinates(data.points)
        T = transform_tensor(parameters, local.to_pixels(), *(local.from_pixels(),) * 2)
        squared = combine_products(_products(T, local.points), _sampson, 5, np.float64)
        squared *= local.squared_scale()
        return squared.astype(dtype, copy=False)

    def degeneracy(self, data: Correspondences) -> np.ndarray:
        """Return the `TrifocalDegeneracy` of each point set: uint8 (...)."""
        data = checked(data, self.num_frames, self.needs_depth)
        return find_degeneracies(data.points, self.min_conditioning, self.min_centre_angle)

    def degenerate(self, data: Correspondences) -> np.ndarray:
        """Return whether `degeneracy` finds any, except accepted collinear centres: bool (...)."""
        reason = self.degeneracy(data)
        accepted = (reason == TrifocalDegeneracy.COLLINEAR_CENTRES) & self.accept_collinear_centres
        return (reason != TrifocalDegeneracy.NONE) & ~accepted


def _products(T: np.ndarray, points: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the factors of p_0, p_1, q_0, q_1, then for each (a, b) of dE_ab/dx0, dE_ab/dy0 and E_ab."""
    ones = np.ones(points.shape[:-2])
    x0 = np.stack([points[..., 0, 0], points[..., 0, 1], ones], axis=-2)
    x1, x2 = points[..., 1, :], points[..., 2, :]
    factors = []
    for b in (0, 1):
        coefficients = np.concatenate([-T[..., 2, b], T[..., 2, 2]], axis=-1)
        factors.append((coefficients, np.concatenate([x0, x0 * x2[..., None, :, b]], axis=-2)))
    for a in (0, 1):
        coefficients = np.concatenate([-T[..., a, 2], T[..., 2, 2]], axis=-1)
        factors.append((coefficients, np.concatenate([x0, x0 * x1[..., None, :, a]], axis=-2)))
    for a, b in ((0, 0), (0, 1), (1, 0), (1, 1)):
        monomials = np.stack([ones, x1[..., a], x2[..., b], x1[..., a] * x2[..., b]], axis=-2)
        by_x0 = np.stack([T[..., a, b], -T[..., 2, b], -T[..., a, 2], T[..., 2, 2]], axis=-1)
        factors += [(by_x0[..., 0, :], monomials), (by_x0[..., 1, :], monomials)]
        trilinear = x0[..., :, None, :] * monomials[..., None, :, :]
        factors.append(
            (by_x0.reshape(*by_x0.shape[:-2], 12), trilinear.reshape(*trilinear.shape[:-3], 12, trilinear.shape[-1]))
        )
    return factors


def _sampson(products: np.ndarray, squared: np.ndarray) -> None:
    """Fill in e' (D + GG')^-1 e of a block of products, see `TrifocalModel.residual`."""
    p, q = products[0:2], products[2:4]
    by_frame = products[4:16].reshape(2, 2, 3, *products.shape[1:])
    pp, qq = p[0] ** 2 + p[1] ** 2, q[0] ** 2 + q[1] ** 2
    p, q = p / np.sqrt(np.maximum(pp, _TINY)), q / np.sqrt(np.maximum(qq, _TINY))
    # Columns along and across p, then rows along and across q, without the entry across both.
    along, across = by_frame[:, 0] * p[0] + by_frame[:, 1] * p[1], by_frame[:, 1] * p[0] - by_frame[:, 0] * p[1]
    both = along[0] * q[0] + along[1] * q[1]
    only_p = along[1] * q[0] - along[0] * q[1]
    only_q = across[0] * q[0] + across[1] * q[1]
    energy, g00, g01, g11, h0, h1 = np.zeros_like(squared), 1.0, 0.0, 1.0, 0.0, 0.0
    for (gx, gy, e), diagonal in ((both, pp + qq), (only_p, pp), (only_q, qq)):
        weight = 1 / np.maximum(diagonal, _TINY)
        energy += e * e * weight
        g00, g01, g11 = g00 + gx * gx * weight, g01 + gx * gy * weight, g11 + gy * gy * weight
        h0, h1 = h0 + gx * e * weight, h1 + gy * e * weight
    # At least 1, but lost to rounding where points are on a line.
    determinant = np.maximum(g00 * g11 - g01 * g01, 1.0)
    explained = (g11 * h0 * h0 - 2 * g01 * h0 * h1 + g00 * h1 * h1) / determinant
    np.maximum(energy - explained, 0, out=squared)
