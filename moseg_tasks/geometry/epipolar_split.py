"""Displacements along and across the epipolar lines of a calibrated camera's rigid motion."""

from typing import NamedTuple

import numpy as np

_PARALLAX_FLOOR = 1e-6  # px; avoids division by zero at the epipole


class EpipolarSplit(NamedTuple):
    """Displacements relative to the camera's rotation, along and across the epipolar lines; all arrays of one shape.

    Attributes
    ----------
    across : px; 0 for static points of any depth.
    along : px; the parallax, which grows with inverse depth.
    reach : px; derivative of the parallax by inverse depth at infinity.
    towards_x, towards_y : unit vector of growing inverse depth.
    rotated_x, rotated_y : px; position of a point at infinity.
    scale : depth in frame 0 over depth in frame 1 of a point at infinity.
    """

    across: np.ndarray
    along: np.ndarray
    reach: np.ndarray
    towards_x: np.ndarray
    towards_y: np.ndarray
    rotated_x: np.ndarray
    rotated_y: np.ndarray
    scale: np.ndarray


def split_along_epipolar(
    x0: np.ndarray, y0: np.ndarray, x1: np.ndarray, y1: np.ndarray, infinite: np.ndarray, epipole: np.ndarray
) -> EpipolarSplit:
    """Split displacements from (x0, y0) to (x1, y1) into parts along and across the epipolar lines.

    With H = K R K^-1, a pixel x at inverse depth d is seen at H x + d K t (homogeneous). At d = 0 its position
    is that of the rotation alone; from there it moves along its epipolar line.

    Parameters
    ----------
    x0, y0, x1, y1 : float32 or float64
        px; of shapes that broadcast, all of one dtype, which is also that of the result.
    infinite : (3, 3)
        H, of that dtype.
    epipole : (3,)
        K t, of that dtype.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry in Computer Vision, 2nd ed., 2004, eq. 9.7.
    """
    scale = 1 / (infinite[2, 0] * x0 + (infinite[2, 1] * y0 + infinite[2, 2]))
    rotated_x = (infinite[0, 0] * x0 + (infinite[0, 1] * y0 + infinite[0, 2])) * scale
    rotated_y = (infinite[1, 0] * x0 + (infinite[1, 1] * y0 + infinite[1, 2])) * scale
    towards_x, towards_y = (epipole[0] - epipole[2] * rotated_x) * scale, (epipole[1] - epipole[2] * rotated_y) * scale
    reach = np.maximum(np.sqrt(towards_x * towards_x + towards_y * towards_y), scale.dtype.type(_PARALLAX_FLOOR))
    towards_x /= reach
    towards_y /= reach
    left_x, left_y = x1 - rotated_x, y1 - rotated_y
    along = left_x * towards_x + left_y * towards_y
    across = left_x * towards_y - left_y * towards_x
    return EpipolarSplit(across, along, reach, towards_x, towards_y, rotated_x, rotated_y, scale)
