"""Sums of monomial products over one object's pixels, each pixel read once.

On a row of the image y is constant, so every entry of the Gram matrix is a combination of row sums of a few planes
(the mask, rho, rho², the flow and their products) against powers of x: two small matrix products per object instead of
a product for each pair of design columns.
"""

from typing import NamedTuple

import numpy as np

from moseg.tasks.motion_models.monomials import EXPONENTS, Frame, image_coordinates

_BLOCK = 16384  # pixels processed at once: their planes fit the processor's second-level cache
_PAIR = EXPONENTS[:, None, :] + EXPONENTS[None, :, :]
_COLUMN = np.array([0, 1, 0, 2, 1, 0])  # powers of xi and eta of the six monomials without depth
_ROW = np.array([0, 0, 1, 0, 1, 2])


class PixelSums(NamedTuple):
    """Normal equations of one object in its local monomials.

    Attributes
    ----------
    gram : float64 (9, 9)
    cross : float64 (9, 2)
        Products of the monomials with the residual of u and v under the prior coefficients.
    energy : float
        Sum of squares of that residual, px².
    count : int
        Pixels.
    """

    gram: np.ndarray
    cross: np.ndarray
    energy: float
    count: int


class Pixels(NamedTuple):
    """One object's bounding box: mask bool (h, w), flow (h, w, 2), inverse depth (h, w) or None, corner (y, x)."""

    mask: np.ndarray
    flow: np.ndarray
    rho: np.ndarray | None
    corner: tuple[int, int]
    image_shape: tuple[int, int]

    def local_axes(self, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Return local xi (w,) and eta (h,) of the box's columns and rows."""
        x, y = image_coordinates(*self.image_shape)
        (row, column), (h, w) = self.corner, self.mask.shape
        return (x[column : column + w] - frame.x0) / frame.scale, (y[row : row + h] - frame.y0) / frame.scale


def sum_pixels(pixels: Pixels, frame: Frame, prior: np.ndarray) -> PixelSums:
    """Sum local monomials, and the flow minus its prior, over the object's pixels.

    Parameters
    ----------
    pixels : Pixels
    frame : Frame
        The object's local coordinates.
    prior : float64 (9, 2)
        Coefficients of u and v on the local monomials, subtracted from the flow: near a solution the sums are then of
        the residual itself, not a small difference of large numbers.
    """
    xi, eta = pixels.local_axes(frame)
    powers_x, powers_y = np.vander(xi, 5, increasing=True), np.vander(eta, 5, increasing=True)
    num_planes = 4 if pixels.rho is None else 8
    sums = np.zeros((num_planes, 5, 5))
    step = max(1, _BLOCK // len(xi))
    for top in range(0, len(eta), step):
        rows = slice(top, top + step)
        planes = _planes(pixels, frame, prior, rows, powers_x, powers_y[rows])
        by_row = planes.reshape(-1, len(xi)) @ powers_x
        sums += powers_y[rows].T @ by_row.reshape(num_planes, -1, 5)
    return _normal_equations(sums)


def _planes(pixels, frame, prior, rows, powers_x, powers_y) -> np.ndarray:
    """Return masked planes 1, e_u, e_v, e² and, with depth, zeta, zeta², zeta e_u, zeta e_v: (4 or 8, rows, w)."""
    mask = pixels.mask[rows]
    planes = np.empty((4 if pixels.rho is None else 8, *mask.shape))
    planes[0] = mask
    zeta = None
    if pixels.rho is not None:
        zeta = planes[4]
        plane_y, plane_x = frame.rho0 + frame.rho_y * powers_y[:, 1], frame.rho_x * powers_x[:, 1]
        np.subtract(pixels.rho[rows], plane_y[:, None], out=zeta)
        zeta -= plane_x
        zeta *= 1.0 / frame.rho_scale
    for component in (0, 1):
        left = planes[1 + component]
        np.subtract(
            pixels.flow[rows, :, component], _prior_flow(prior[:, component], zeta, powers_x, powers_y), out=left
        )
        left *= planes[0]
    np.multiply(planes[1], planes[1], out=planes[3])
    planes[3] += planes[2] * planes[2]
    if zeta is not None:
        np.multiply(planes[1:3], zeta, out=planes[6:8])
        zeta *= planes[0]
        np.multiply(zeta, zeta, out=planes[5])
    return planes


def _prior_flow(prior, zeta, powers_x, powers_y) -> np.ndarray:
    constant = np.zeros((3, 3))
    constant[_ROW, _COLUMN] = prior[:6]
    flow = powers_y[:, :3] @ constant @ powers_x[:, :3].T
    if zeta is not None:
        slope = np.array([[prior[6], prior[7]], [prior[8], 0.0]])
        flow += zeta * (powers_y[:, :2] @ slope @ powers_x[:, :2].T)
    return flow


def _normal_equations(sums: np.ndarray) -> PixelSums:
    with_depth = len(sums) == 8
    size = 9 if with_depth else 6
    gram, cross = np.zeros((9, 9)), np.zeros((9, 2))
    by_depth = sums[[0, 4, 5]] if with_depth else sums[[0]]
    pair = _PAIR[:size, :size]
    gram[:size, :size] = by_depth[pair[..., 2], pair[..., 1], pair[..., 0]]
    cross[:6] = sums[1:3, _ROW, _COLUMN].T
    if with_depth:
        cross[6:] = sums[6:8, [0, 0, 1], [0, 1, 0]].T
    return PixelSums(gram, cross, float(sums[3, 0, 0]), round(sums[0, 0, 0]))
