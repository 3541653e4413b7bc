"""Local coordinates fitted to an object, and sums over a coarse grid of its pixels, for a first fit."""

import math

import numpy as np

from moseg.tasks.motion_models.monomials import Frame, evaluate_monomials, image_coordinates
from moseg.tasks.motion_models.pixel_sums import Pixels

_GRID_PIXELS = 512  # several dozen for each parameter; more gain nothing, because the full sums correct the fit


def sum_coarsely(pixels: Pixels) -> tuple[Frame, np.ndarray, np.ndarray]:
    """Return local coordinates and, over a grid of about 512 pixels, sums of monomials: (9, 9), with the flow (9, 2).

    Without depth the inverse depth is 1.
    """
    h, w = pixels.mask.shape
    step = max(1, math.isqrt(int(np.count_nonzero(pixels.mask)) // _GRID_PIXELS))
    rows, columns = np.nonzero(pixels.mask[::step, ::step])
    rows, columns = rows * step, columns * step
    x, y = image_coordinates(*pixels.image_shape)
    top, left = pixels.corner
    half = max(h, w) / max(pixels.image_shape)
    x0, y0 = (x[left] + x[left + w - 1]) / 2, (y[top] + y[top + h - 1]) / 2
    local = Frame(x0, y0, half, 1.0, 0.0, 0.0, 1.0)
    xi, eta = pixels.local_axes(local)
    xi, eta, zeta = xi[columns], eta[rows], np.zeros(len(rows))
    if pixels.rho is not None:
        local, zeta = _with_depth_plane(local, xi, eta, pixels.rho[rows, columns].astype(np.float64))
    monomials = evaluate_monomials(xi, eta, zeta)
    return local, monomials.T @ monomials, monomials.T @ pixels.flow[rows, columns].astype(np.float64)


def _with_depth_plane(local: Frame, xi, eta, rho) -> tuple[Frame, np.ndarray]:
    """Return the frame with a plane fitted to the inverse depth at some points, and zeta at these points."""
    axes = np.stack([np.ones_like(xi), xi, eta], axis=1)
    plane = np.linalg.lstsq(axes, rho)[0]
    left = rho - axes @ plane
    deviation = math.sqrt(float(left @ left) / max(len(left), 1))
    scale = deviation if deviation > 0 else 1.0
    return local._replace(rho0=plane[0], rho_x=plane[1], rho_y=plane[2], rho_scale=scale), left / scale
