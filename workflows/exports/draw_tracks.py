"""Points and their recent paths as a transparent picture that can lie over any other."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.workflows.exports.draw_regions import reduce_transparent

TAIL_FRAMES = 8
"""Length of a tail, frames."""
_OVERSAMPLING = 2
_SHIFT = 3  # binary digits of a pixel's fraction, as OpenCV takes them
_RIM_OPACITY = 0.7
_TAIL_WIDTH = 1
# Of a tail's oldest part; the newest has 1.
_MIN_OPACITY = 0.25


class DrawnPoints(NamedTuple):
    """Points of some frames, of which the last one is drawn and the others are its past.

    Attributes
    ----------
    points : floating (N, F, xy)
        px of a frame of `size`, pixel centres at integers; F = 1 draws no tails.
    visible : bool (N, F)
    colours : uint8 (N, rgb)
    size : (int, int)
        Height and width, px.
    """

    points: np.ndarray
    visible: np.ndarray
    colours: np.ndarray
    size: tuple[int, int]

    def until(self, frame: int) -> "DrawnPoints":
        """Return the points up to a frame, with as much past as a tail shows."""
        recent = slice(max(frame - TAIL_FRAMES, 0), frame + 1)
        return self._replace(points=self.points[:, recent], visible=self.visible[:, recent])


def draw_tracks(drawn: DrawnPoints, shape: tuple[int, int], radius: float) -> np.ndarray:
    """Draw a dot at each point visible in the last frame, and its path as far back as it was visible without a gap.

    Parameters
    ----------
    drawn : DrawnPoints
        Later points lie above earlier ones.
    shape : (int, int)
        Height and width of the picture, px.
    radius : float
        Of a dot, px of the picture, with its dark rim half a pixel more.

    Returns
    -------
    uint8 (y, x, rgba)
        Transparent where there is no point.
    """
    large = tuple(side * _OVERSAMPLING for side in shape)
    canvas = np.zeros((*large, 4), np.float32)
    seen = np.flatnonzero(drawn.visible[:, -1])
    scale = np.array([large[1] / drawn.size[1], large[0] / drawn.size[0]])
    # Rounded once: OpenCV takes whole parts of a pixel.
    places = np.rint(((drawn.points[seen] + 0.5) * scale - 0.5) * 2**_SHIFT).astype(int)
    colours = drawn.colours[seen].astype(float)
    lengths = _unbroken(drawn.visible[seen])
    for back in range(min(TAIL_FRAMES, places.shape[1] - 1), 0, -1):
        opacity = 1 - (1 - _MIN_OPACITY) * (back - 1) / TAIL_FRAMES
        for index in np.flatnonzero(lengths > back):
            start, end = places[index, -1 - back].tolist(), places[index, -back].tolist()
            ink = (*(opacity * colours[index]), opacity)
            cv2.line(canvas, start, end, ink, _TAIL_WIDTH * _OVERSAMPLING, cv2.LINE_8, _SHIFT)
    for index in range(len(seen)):
        centre = places[index, -1].tolist()
        for grown, ink in ((0.75, (0, 0, 0, _RIM_OPACITY)), (0, (*colours[index], 1))):
            size = round((radius + grown) * _OVERSAMPLING * 2**_SHIFT)
            cv2.circle(canvas, centre, size, ink, cv2.FILLED, cv2.LINE_8, _SHIFT)
    return reduce_transparent(canvas, shape)


def _unbroken(visible: np.ndarray) -> np.ndarray:
    """Return for each track the number of consecutive frames, up to the last one, in which it was visible."""
    hidden = ~visible[:, ::-1]
    return np.where(hidden.any(axis=1), hidden.argmax(axis=1), visible.shape[1])
