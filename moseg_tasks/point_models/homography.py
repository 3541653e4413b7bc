"""The homography: four points, a plane or a camera that only rotates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike

from moseg.tasks.geometry.coordinates import hartley_transform
from moseg.tasks.geometry.homography import homography_dlt, transfer_equations
from moseg.tasks.point_models.blocks import combine_products
from moseg.tasks.point_models.correspondences import Correspondences, checked, checked_for_fit
from moseg.tasks.point_models.local_coordinates import local_coordinates


@dataclass(frozen=True)
class HomographyModel:
    """x1 ~ H x0 with H float64 (3, 3) of unit Frobenius norm on homogeneous pixels.

    Attributes
    ----------
    min_conditioning : float
        Smallest ratio of the eighth to the first singular value of the Hartley-normalised transfer equations, and of
        the third to the first of the homography itself, for points that determine it.
    """

    min_conditioning: float = 1e-3
    name: str = "homography"
    num_frames: int = 2
    sample_size: int = 4
    needs_depth: bool = False

    def fit(self, data: Correspondences) -> np.ndarray:
        """Return float64 (..., 3, 3): of four points in closed form, of more by the direct linear transform."""
        data = checked_for_fit(data, self.num_frames, self.needs_depth, self.sample_size)
        points0, points1 = data.points[..., 0, :], data.points[..., 1, :]
        if data.num_points == self.sample_size:
            return _through_four_points(points0, points1)
        return homography_dlt(points0, points1)

    def residual(self, parameters: np.ndarray, data: Correspondences, dtype: DTypeLike = np.float64) -> np.ndarray:
        """Return the squared Sampson distance, px^2 (..., H, N).

        e' (JJ')^-1 e with e the two transfer equations. Both components of e and the three entries of JJ' are
        polynomials in (x0, y0, x1, y1), linear in products of entries of H: five matrix products.

        References
        ----------
        R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, section 4.2.6.
        """
        data = checked(data, self.num_frames, self.needs_depth)
        local = local_coordinates(data.points)
        H = local.from_pixels() @ parameters @ local.to_pixels()
        H = H / np.linalg.norm(H, axis=(-2, -1), keepdims=True)
        squared = combine_products(_products(H, local.points), _sampson, 1, dtype)
        squared *= local.squared_scale().astype(dtype)
        return squared

    def degenerate(self, data: Correspondences) -> np.ndarray:
        """Return whether three of four points, or nearly all of more, are collinear in a frame: bool (...)."""
        data = checked(data, self.num_frames, self.needs_depth)
        if data.num_points < self.sample_size:
            return np.ones(data.points.shape[:-3], dtype=bool)
        normalised = [hartley_transform(data.points[..., frame, :])[0] for frame in (0, 1)]
        equations = np.linalg.svd(transfer_equations(*normalised), compute_uv=False)
        H = np.linalg.svd(self.fit(data._replace(points=np.stack(normalised, axis=-2))), compute_uv=False)
        return (equations[..., 7] < self.min_conditioning * equations[..., 0]) | (
            H[..., 2] < self.min_conditioning * H[..., 0]
        )


def _through_four_points(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the homographies (..., 3, 3) of four points (..., 4, 2) each.

    With m a matrix of three homogeneous points and l = adj(m) p4, the basis m diag(l) maps the unit points to all
    four: H = m1 diag(l1) (m0 diag(l0))^-1, here without a division by zero.
    """
    normalised0, T0 = hartley_transform(points0)
    normalised1, T1 = hartley_transform(points1)
    _, adjugate0, l0 = _projective_basis(normalised0)
    m1, _, l1 = _projective_basis(normalised1)
    others = l0[..., [1, 2, 0]] * l0[..., [2, 0, 1]]
    H = (m1 * (l1 * others)[..., None, :]) @ adjugate0
    # For coincident points H is zero; the identity between the normalised frames replaces it.
    norm = np.linalg.norm(H, axis=(-2, -1), keepdims=True)
    H = np.where(norm > np.finfo(np.float64).tiny, H, np.eye(3))
    H = np.linalg.inv(T1) @ H @ T0
    return H / np.linalg.norm(H, axis=(-2, -1), keepdims=True)


def _projective_basis(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the first three of four points as columns m (..., 3, 3), adj(m), and adj(m) p4 (..., 3)."""
    m = np.ones((*points.shape[:-2], 3, 3))
    m[..., :2, :] = np.swapaxes(points[..., :3, :], -1, -2)
    x, y = m[..., 0, :], m[..., 1, :]
    after, before = [1, 2, 0], [2, 0, 1]
    adjugate = np.stack(
        [
            y[..., after] - y[..., before],
            x[..., before] - x[..., after],
            x[..., after] * y[..., before] - x[..., before] * y[..., after],
        ],
        axis=-1,
    )
    weights = (adjugate[..., :2] @ points[..., 3, :, None])[..., 0] + adjugate[..., 2]
    return m, adjugate, weights


def _sampson(products: np.ndarray, squared: np.ndarray) -> None:
    """Fill in e' (JJ')^-1 e of a block of errors e_x, e_y and entries a, b, c of JJ', where b^2 <= a c."""
    error_x, error_y, a, b, c, spare = products
    np.multiply(a, c, out=squared)
    np.multiply(b, b, out=spare)
    squared -= spare
    np.maximum(squared, np.finfo(squared.dtype).tiny, out=squared)
    b *= error_x
    b *= error_y
    b *= 2
    error_x *= error_x
    error_x *= c
    error_y *= error_y
    error_y *= a
    error_x += error_y
    error_x -= b
    np.maximum(error_x, 0, out=error_x)
    np.divide(error_x, squared, out=squared)


def _products(H: np.ndarray, points: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return factors (..., H, K) and (..., K, N) of the errors e_x, e_y and of the entries a, b, c of JJ'."""
    x, y = points[..., 0, 0], points[..., 0, 1]
    x1, y1 = points[..., 1, 0], points[..., 1, 1]
    one = np.ones_like(x)

    def over_points(*rows):
        return np.stack(rows, axis=-2)

    def over_models(*columns):
        return np.stack(columns, axis=-1)

    h, k, w = H[..., 0, :], H[..., 1, :], H[..., 2, :]
    # e = (h x0 - x w x0) - (x1 - x) w x0: with the displacement, small errors are accurate in single precision.
    ux, uy = x1 - x, y1 - y
    scale_x, scale_y = h[..., 0] - w[..., 2], k[..., 1] - w[..., 2]
    error_x = over_models(h[..., 2], scale_x, h[..., 1], -w[..., 0], -w[..., 1], -w[..., 0], -w[..., 1], -w[..., 2])
    error_y = over_models(k[..., 2], k[..., 0], scale_y, -w[..., 0], -w[..., 1], -w[..., 0], -w[..., 1], -w[..., 2])
    # JJ' = (h - x1 w)(h - x1 w)' over the first two columns, and the square of the weight w x0 on its diagonal.
    hh, hk, kk = (np.sum(p[..., :2] * q[..., :2], axis=-1) for p, q in ((h, h), (h, k), (k, k)))
    hw, kw, ww = (np.sum(p[..., :2] * q[..., :2], axis=-1) for p, q in ((h, w), (k, w), (w, w)))
    weight = (w[..., 0] ** 2, w[..., 1] ** 2, 2 * w[..., 0] * w[..., 1], 2 * w[..., 0] * w[..., 2])
    weight = (*weight, 2 * w[..., 1] * w[..., 2])
    squares = (x * x, y * y, x * y, x, y)
    constant = w[..., 2] ** 2
    return [
        (error_x, over_points(one, x, y, x * x, x * y, ux * x, ux * y, ux)),
        (error_y, over_points(one, x, y, x * y, y * y, uy * x, uy * y, uy)),
        (over_models(hh + constant, -2 * hw, ww, *weight), over_points(one, x1, x1 * x1, *squares)),
        (over_models(hk, -hw, -kw, ww), over_points(one, y1, x1, x1 * y1)),
        (over_models(kk + constant, -2 * kw, ww, *weight), over_points(one, y1, y1 * y1, *squares)),
    ]
