"""Frames whose black bars are filled."""

import cv2
import numpy as np

from moseg.schemas.black_bars import BlackBars


def fill_bars(image: np.ndarray, bars: BlackBars) -> np.ndarray:
    """Return a frame whose bars continue the border of the picture, as if it were seen through a wider window.

    What moves at the border moves in the filled bar too, so that a bar is no still part of the scene.

    Parameters
    ----------
    image : uint8 (y, x, 3)
    bars : BlackBars
        They leave a picture.

    Returns
    -------
    uint8 (y, x, 3)
        The picture where it was, and in each bar the pixel of the picture that is nearest.
    """
    picture = image[bars.picture(image.shape[:2])]
    return cv2.copyMakeBorder(picture, bars.top, bars.bottom, bars.left, bars.right, cv2.BORDER_REPLICATE)
