"""Guided filter by a colour image."""

import cv2
import numpy as np


def guided_coefficients(
    guide: np.ndarray, filtered: np.ndarray, radius: int, smoothness: float
) -> tuple[np.ndarray, np.ndarray]:
    """Fit a local linear model of a map by an image's colours: ``filtered ~ slope . colour + offset``.

    Coefficients of a coarse grid may be enlarged and applied to the full image: outlines then follow its edges at a
    fraction of the cost.

    Parameters
    ----------
    guide : float32 (y, x, 3)
        Colours, 0..1.
    filtered : float32 (y, x)
    radius : int
        Half side of the window, px.
    smoothness : float
        Variance of colour below which a window is treated as flat.

    Returns
    -------
    slope : float32 (y, x, 3)
    offset : float32 (y, x)

    References
    ----------
    He, Sun, Tang, "Guided Image Filtering", PAMI 2013, equations 14 and 15; He, Sun, "Fast Guided Filter", 2015.
    """
    side = (2 * radius + 1, 2 * radius + 1)

    def mean(image: np.ndarray) -> np.ndarray:
        return cv2.blur(image, side, borderType=cv2.BORDER_REFLECT)

    red, green, blue = cv2.split(guide)
    products = cv2.merge([red * red, green * green, blue * blue])
    crosses = cv2.merge([red * green, red * blue, green * blue])
    centre, level = mean(guide), mean(filtered)
    variance = mean(products) - centre * centre + np.float32(smoothness)
    across = mean(crosses) - centre[..., [0, 0, 1]] * centre[..., [1, 2, 2]]
    covariance = mean(guide * filtered[..., None]) - centre * level[..., None]
    slope = _solve_symmetric(cv2.split(variance), cv2.split(across), cv2.split(covariance))
    offset = level - _dot(slope, centre)
    return mean(slope), mean(offset)


def apply_coefficients(guide: np.ndarray, slope: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Return slope . colour + offset float32 (Y, X) on a `guide` float32 (Y, X, 3); coefficients are resized to it."""
    size = guide.shape[1::-1]
    enlarged = cv2.resize(cv2.merge([*cv2.split(slope), offset]), size, interpolation=cv2.INTER_LINEAR)
    return _dot(enlarged[..., :3], guide) + enlarged[..., 3]


def _dot(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return cv2.transform(left * right, np.ones((1, 3), np.float32))


def _solve_symmetric(diagonal, across, right) -> np.ndarray:
    """Solve ``A x = right`` with the symmetric 3x3 A of each pixel by cofactors: x float32 (y, x, 3)."""
    rr, gg, bb = diagonal
    rg, rb, gb = across
    c00, c01, c02 = gg * bb - gb * gb, rb * gb - rg * bb, rg * gb - rb * gg
    c11, c12, c22 = rr * bb - rb * rb, rg * rb - rr * gb, rr * gg - rg * rg
    scale = 1 / (rr * c00 + rg * c01 + rb * c02)
    x, y, z = right
    return cv2.merge(
        [
            (c00 * x + c01 * y + c02 * z) * scale,
            (c01 * x + c11 * y + c12 * z) * scale,
            (c02 * x + c12 * y + c22 * z) * scale,
        ]
    )
