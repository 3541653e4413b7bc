"""What stands on the ground: parallax that grows out of it without a jump."""

import numpy as np


def unsupported_parallax(
    inverse_depth: np.ndarray, reach: np.ndarray, buried: np.ndarray, tolerance: np.ndarray
) -> np.ndarray:
    """Return the parallax that no static thing standing on the ground can have.

    Whatever is static stands on something that is seen below it, unless something nearer hides that. So inverse depth
    that grows on the way up is a jump that needs an explanation, while inverse depth that falls is a thing seen over
    the edge of a nearer one; sideways either is a jump. A pixel's measure is the sum of the jumps along the best way
    to it from the frame's lower border, which only goes up and sideways, and is never less than what it is `buried`
    under the ground itself.

    Parameters
    ----------
    inverse_depth : float32 (y, x)
        Relative.
    reach : float32 (y, x)
        Parallax at unit inverse depth, px/frame.
    buried : float32 (y, x)
        How much parallax a pixel lacks to lie on the ground, px/frame, at least 0.
    tolerance : float32 (y, x)
        Change of parallax from one pixel to the next that is no jump, px/frame.

    Returns
    -------
    jump : float32 (y, x)
        px/frame.
    """
    height, width = inverse_depth.shape
    up = (inverse_depth[:-1] - inverse_depth[1:]) * reach[:-1] - tolerance[:-1]
    np.maximum(up, 0, out=up)
    beside = np.abs(inverse_depth[:, 1:] - inverse_depth[:, :-1]) * reach[:, 1:] - tolerance[:, 1:]
    # Travelled sums turn the cheapest way along a row into a running minimum from either side.
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
