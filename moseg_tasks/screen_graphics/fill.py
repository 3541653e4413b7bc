"""Frames whose graphics are filled."""

from functools import lru_cache

import cv2
import numpy as np

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.screen_graphics import ScreenGraphics


def graphics_mask(graphics: ScreenGraphics, shape: tuple[int, int]) -> np.ndarray:
    """Return where graphics are in frames of `shape`, bool (y, x)."""
    mask = np.zeros(shape, np.uint8)
    for part in graphics.parts:
        cv2.fillConvexPoly(mask, np.asarray(part, np.int32), 1)
    return mask.astype(bool)


def fill_graphics(image: np.ndarray, graphics: ScreenGraphics, bars: BlackBars) -> np.ndarray:
    """Return a frame whose graphics, and black bars, have the colours of the scene that is nearest.

    What moves beside them moves in them too, so that they are no still part of the scene.

    Parameters
    ----------
    image : uint8 (y, x, 3)
    graphics : ScreenGraphics
    bars : BlackBars
        They and the graphics leave a part of the frame.

    Returns
    -------
    uint8 (y, x, 3)
        The scene where it was, and elsewhere the pixel of the scene that is nearest.
    """
    parts = tuple(tuple(map(tuple, part)) for part in graphics.parts)
    hidden, nearest = _nearest(ScreenGraphics(parts), bars, image.shape[:2])
    filled = image.reshape(-1, image.shape[2]).copy()
    filled[hidden] = filled[nearest]
    return filled.reshape(image.shape)


@lru_cache(2)
def _nearest(graphics: ScreenGraphics, bars: BlackBars, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of the pixels to be filled in the flat frame, and of the pixel of the scene nearest to each."""
    hidden = np.ones(shape, np.uint8)
    picture = bars.picture(shape)
    hidden[picture] = graphics_mask(graphics, shape)[picture]
    _, labels = cv2.distanceTransformWithLabels(hidden, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    seen = np.flatnonzero(hidden == 0)
    place = np.zeros(labels.max() + 1, np.intp)
    place[labels.ravel()[seen]] = seen
    filled = np.flatnonzero(hidden)
    return filled, place[labels.ravel()[filled]]
