"""Black bars of a video: lines at its sides that are dark in all frames, up to a straight edge of the picture."""

from collections.abc import Iterable

import numpy as np

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.parameters import BlackBarParams

_NEAR_EDGE = 2
"""Lines of the picture beside a bar, of which the first may be mixed with it where frames are reduced."""


def find_bars(images: Iterable[np.ndarray], params: BlackBarParams) -> BlackBars:
    """Find the black bars of a video.

    A row or column of a bar is dark in every frame. A dark part of the scene, such as the sky at night, may be so too,
    but it ends where something bright happens to be: at the edge of a bar, most of the picture's line is brighter at
    once.

    Parameters
    ----------
    images : iterable of uint8 (y, x, 3)
        Frames of one size, at least one, spread over the video.
    params : BlackBarParams

    Returns
    -------
    BlackBars
        None in frames that are black all over, or that have too small a picture between bars.
    """
    bright = np.stack([(image > params.max_level).any(axis=-1) for image in images])
    height, width = bright.shape[1:]
    is_dark = [(bright.mean(axis=axis) <= params.max_bright).all(axis=0) for axis in (2, 1)]
    if any(lines.all() for lines in is_dark):
        return BlackBars()
    (top, bottom), (left, right) = ((int(lines.argmin()), int(lines[::-1].argmin())) for lines in is_dark)
    rows, columns = BlackBars(left, top, right, bottom).picture((height, width))
    picture = bright[:, rows, columns]
    top, bottom = (_checked(*each, height, params) for each in ((top, picture), (bottom, picture[:, ::-1])))
    across = picture.swapaxes(1, 2)
    left, right = (_checked(*each, width, params) for each in ((left, across), (right, across[:, ::-1])))
    if height - top - bottom < params.min_picture * height or width - left - right < params.min_picture * width:
        return BlackBars()
    return BlackBars(left, top, right, bottom)


def _checked(length: int, picture: np.ndarray, side: int, params: BlackBarParams) -> int:
    """Return the width of a bar, 0 unless it is one, before the lines of a picture bool (frame, line, pixel)."""
    edge = picture[:, :_NEAR_EDGE].mean(axis=2).max(initial=0)
    return length if length >= params.min_width * side and edge >= params.min_edge else 0
