"""Strokes of a round brush, drawn on a frame as it is analysed."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.corrections import Stroke


def draw_strokes(strokes: Sequence[Stroke], shape: tuple[int, int], frame_size: tuple[int, int]) -> np.ndarray:
    """Return the pixels under strokes, bool (y, x) of `shape`.

    A pixel is under a stroke if its centre is within the radius of the line; a stroke thinner than the distance between
    pixels still covers those that the line passes.

    Parameters
    ----------
    strokes : sequence of Stroke
        Points and radii in px of the video's own frames.
    shape : (height, width)
        Of the frame as analysed, px.
    frame_size : (height, width)
        Of the video's own frames, px.
    """
    scale = np.array([shape[1] / frame_size[1], shape[0] / frame_size[0]])
    drawn = np.zeros(shape, bool)
    for stroke in strokes:
        points = analysed_points(stroke.points, shape, frame_size)
        radius = max(stroke.radius * float(scale.mean()), np.sqrt(0.5))
        for start, stop in zip(points, points[1:] if len(points) > 1 else points, strict=False):
            _draw_segment(drawn, start, stop, radius)
    return drawn


def analysed_points(
    points: Sequence[tuple[float, float]], shape: tuple[int, int], frame_size: tuple[int, int]
) -> np.ndarray:
    """Return points xy, px of the video's own frames, in px of frames of `shape`: float64 (point, 2)."""
    scale = np.array([shape[1] / frame_size[1], shape[0] / frame_size[0]])
    # Pixel centres are at integers: the frame's corner is half a pixel before the first one.
    return (np.array(points, np.float64).reshape(-1, 2) + 0.5) * scale - 0.5


def _draw_segment(drawn: np.ndarray, start: np.ndarray, stop: np.ndarray, radius: float) -> None:
    """Set the pixels whose distance to the segment start..stop (xy) is at most `radius`, px."""
    sides = np.array(drawn.shape[::-1])
    low = np.clip(np.floor(np.minimum(start, stop) - radius), 0, sides).astype(int)
    high = np.clip(np.ceil(np.maximum(start, stop) + radius) + 1, 0, sides).astype(int)
    y, x = np.ogrid[low[1] : high[1], low[0] : high[0]]
    along = stop - start
    length = float(along @ along)
    offset_x, offset_y = x - start[0], y - start[1]
    share = np.clip((offset_x * along[0] + offset_y * along[1]) / length, 0, 1) if length else 0.0
    apart = (offset_x - share * along[0]) ** 2 + (offset_y - share * along[1]) ** 2
    drawn[low[1] : high[1], low[0] : high[0]] |= apart <= radius**2
