"""Optical flow in colours: hue is its direction, saturation its length."""

from functools import cache
from itertools import pairwise

import numpy as np

UNKNOWN_FLOW = (0, 0, 0)
"""RGB of a pixel with unknown flow; no vector has this colour."""
# Number of hues from one of six corners of the colour cube to the next: red, yellow, green, cyan, blue, magenta, red.
# The eye distinguishes some better than others.
_STEPS = (15, 6, 4, 11, 13, 6)
_CORNERS = ((255, 0, 0), (255, 255, 0), (0, 255, 0), (0, 255, 255), (0, 0, 255), (255, 0, 255), (255, 0, 0))
# Brightness of vectors longer than the scale.
_BEYOND = 0.75


def colour_flow(flow: np.ndarray, longest: float) -> np.ndarray:
    """Return the colours of vectors as the Middlebury benchmark draws them.

    No motion is white, a vector as long as `longest` has its direction's full colour, a longer one that colour darker.
    To the right is red, down yellow, to the left cyan, up violet.

    Parameters
    ----------
    flow : floating (..., uv)
        x to the right, y down; not finite where it is unknown, which becomes black.
    longest : float
        In the flow's unit; 0 or less is taken as the smallest number above 0.

    Returns
    -------
    uint8 (..., rgb)

    References
    ----------
    Baker, Scharstein, Lewis, Roth, Black, Szeliski, "A Database and Evaluation Methodology for Optical Flow", IJCV
    2011.
    """
    known = np.isfinite(flow).all(axis=-1)
    vectors = np.where(known[..., None], flow, 0).astype(np.float64) / max(longest, np.finfo(float).tiny)
    length = np.hypot(vectors[..., 0], vectors[..., 1])[..., None]
    hues = _direction_colours()
    # From red, to the right, by way of yellow, down. As published the turn ends at the last hue, not back at the first.
    place = np.arctan2(vectors[..., 1], vectors[..., 0]) / (2 * np.pi) % 1 * (len(hues) - 1)
    before = np.floor(place).astype(int)
    share = (place - before)[..., None]
    hue = (1 - share) * hues[before % len(hues)] + share * hues[(before + 1) % len(hues)]
    colours = np.where(length <= 1, 255 - np.minimum(length, 1) * (255 - hue), _BEYOND * hue)
    colours[~known] = UNKNOWN_FLOW
    return colours.astype(np.uint8)


def draw_flow_wheel(side: int) -> np.ndarray:
    """Draw the key of `colour_flow`: a disc whose pixels have the colours of the vectors from its centre to them.

    Parameters
    ----------
    side : int
        Of the square picture, px; the longest vector reaches its border.

    Returns
    -------
    uint8 (side, side, rgba)
        Transparent around the disc, its border one pixel soft.
    """
    radius = side / 2
    across = (np.arange(side) + 0.5 - radius) / radius
    vectors = np.stack(np.meshgrid(across, across), axis=-1)
    outside = np.hypot(vectors[..., 0], vectors[..., 1]) - 1
    # The border's soft pixels have the disc's own colour.
    inner = vectors / np.maximum(outside + 1, 1)[..., None]
    alpha = np.rint(255 * np.clip(0.5 - outside * radius, 0, 1)).astype(np.uint8)
    return np.dstack([colour_flow(inner * (1 - 1e-9), 1.0), alpha])


@cache
def _direction_colours() -> np.ndarray:
    """Return the wheel's 55 hues, float64 (55, rgb)."""
    runs = []
    for (start, end), steps in zip(pairwise(np.array(_CORNERS)), _STEPS, strict=True):
        rise = 255 * np.arange(steps) // steps
        runs.append(start + np.sign(end - start) * rise[:, None])
    hues = np.concatenate(runs).astype(np.float64)
    hues.flags.writeable = False
    return hues
