"""The nine functions of (x, y, rho) in which every flow model is linear, and their change under recentring.

Basis, in order: 1, x, y, x², xy, y², rho, x rho, y rho. Image coordinates are taken relative to the image centre and
divided by half the longer side; rho is inverse depth.
"""

from typing import NamedTuple

import numpy as np

MONOMIALS = ("1", "x", "y", "xx", "xy", "yy", "r", "xr", "yr")
EXPONENTS = np.array([[m.count("x"), m.count("y"), m.count("r")] for m in MONOMIALS])
"""Powers of x, y and rho of each monomial, int (9, 3)."""


class Frame(NamedTuple):
    """Local coordinates x = x0 + scale xi, y = y0 + scale eta, rho = rho0 + rho_x xi + rho_y eta + rho_scale zeta.

    zeta is the residual of a plane fitted to the inverse depth: for a flat object rho is a combination of 1, x and y.
    """

    x0: float
    y0: float
    scale: float
    rho0: float
    rho_x: float
    rho_y: float
    rho_scale: float


def image_coordinates(height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return x (width,) and y (height,) of pixel centres, float64: from the image centre, in half longer sides."""
    half = max(height, width) / 2.0
    return (np.arange(width) - (width - 1) / 2.0) / half, (np.arange(height) - (height - 1) / 2.0) / half


def evaluate_monomials(x: np.ndarray, y: np.ndarray, rho: np.ndarray) -> np.ndarray:
    """Return the nine monomials at N points, float64 (N, 9)."""
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y, rho, x * rho, y * rho], axis=-1)


def recentring(frame: Frame) -> np.ndarray:
    """Return the matrix S, float64 (9, 9), with monomials(x, y, rho) = monomials(xi, eta, zeta) @ S."""
    x0, y0, h, r0, rx, ry, s = frame
    matrix = np.zeros((9, 9))
    one, x, y, xx, xy, yy, r, xr, yr = range(9)
    matrix[one, one] = 1
    matrix[[one, x], x] = x0, h
    matrix[[one, y], y] = y0, h
    matrix[[one, x, xx], xx] = x0 * x0, 2 * x0 * h, h * h
    matrix[[one, x, y, xy], xy] = x0 * y0, y0 * h, x0 * h, h * h
    matrix[[one, y, yy], yy] = y0 * y0, 2 * y0 * h, h * h
    matrix[[one, x, y, r], r] = r0, rx, ry, s
    matrix[[one, x, y, xx, xy, r, xr], xr] = x0 * r0, h * r0 + x0 * rx, x0 * ry, h * rx, h * ry, x0 * s, h * s
    matrix[[one, x, y, xy, yy, r, yr], yr] = y0 * r0, y0 * rx, h * r0 + y0 * ry, h * rx, h * ry, y0 * s, h * s
    return matrix
