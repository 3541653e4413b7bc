"""Turning frames upright as a video's display matrix asks."""

import struct

import numpy as np


def upright(image: np.ndarray, matrix: bytes) -> np.ndarray:
    """Apply a display matrix's quarter turns and mirrorings.

    Parameters
    ----------
    image : (y, x, channel)
    matrix : bytes
        Nine native int32, rows (a, b, u), (c, d, v), (x, y, w): a point goes to x' = a x + c y, y' = b x + d y, axes
        right and down (FFmpeg's `libavutil/display.h`). Scale and translation are ignored, and an angle between two
        quarter turns goes to the nearer one.

    Returns
    -------
    (y', x', channel), contiguous
    """
    a, b, _, c, d, _, _, _, _ = struct.unpack("=9i", matrix)
    if abs(b) + abs(c) > abs(a) + abs(d):
        image, from_x, from_y = image.swapaxes(0, 1), c, b
    else:
        from_x, from_y = a, d
    if from_y < 0:
        image = image[::-1]
    if from_x < 0:
        image = image[:, ::-1]
    return np.ascontiguousarray(image)
