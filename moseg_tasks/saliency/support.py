"""Support by the ground: parallax that is connected to it without a jump."""

import numpy as np


def unsupported_parallax(
    inverse_depth: np.ndarray, reach: np.ndarray, buried: np.ndarray, tolerance: np.ndarray
) -> np.ndarray:
    """Return the parallax that no static thing standing on the ground can have.

    A static thing stands on something that is visible below it, unless something nearer hides that. So inverse depth
    that grows upwards is a jump, while inverse depth that falls upwards is a thing seen over the edge of a nearer one;
    sideways both are jumps. A pixel's result is the sum of the jumps along the cheapest path to it from the frame's
    lower border, which only goes up and sideways, and at least its depth `buried` under the ground.

    Parameters
    ----------
    inverse_depth : float32 (y, x)
        Relative.
    reach : float32 (y, x)
        Parallax at unit inverse depth, px/frame.
    buried : float32 (y, x)
        Parallax that a pixel lacks to lie on the ground, px/frame, at least 0.
    tolerance : float32 (y, x)
        Change of parallax from one pixel to the next that is not yet a jump, px/frame.

    Returns
    -------
    jump : float32 (y, x)
        px/frame.
    """
    height, width = inverse_depth.shape
    up = (inverse_depth[:-1] - inverse_depth[1:]) * reach[:-1] - tolerance[:-1]
    np.maximum(up, 0, out=up)
    beside = np.abs(inverse_depth[:, 1:] - inverse_depth[:, :-1]) * reach[:, 1:] - tolerance[:, 1:]
    # By cumulative sums the cheapest path along a row becomes a running minimum from either side.
    travelled = np.zeros((height, width), np.float32)
    np.cumsum(np.maximum(beside, 0, out=beside), axis=1, out=travelled[:, 1:])
    jump = np.empty((height, width), np.float32)
    jump[-1] = buried[-1]
    for y in range(height - 2, -1, -1):
        below, way = jump[y + 1] + up[y], travelled[y]
        rightwards = np.minimum.accumulate(below - way) + way
        leftwards = np.minimum.accumulate((below + way)[::-1])[::-1] - way
        np.maximum(np.minimum(rightwards, leftwards), buried[y], out=jump[y])
    return jump
