"""Errors of a mask, or of a prediction at labelled points, drawn over the frame."""

from types import MappingProxyType
from typing import NamedTuple

import cv2
import numpy as np

ERROR_COLOURS = MappingProxyType(
    {
        "true positive": (255, 255, 255),
        "false positive": (230, 159, 0),
        "false negative": (0, 114, 178),
    }
)
"""RGB. Of the colours of Okabe and Ito with white, the three that lie farthest apart in the worst of normal vision and
the three dichromacies, by lightness alone too."""
DIMMING = 0.3
"""Share of the frame's brightness that is kept: enough to recognise the scene, darker than every error colour."""
OPACITY = 0.8
"""Share of the error colour in its pixels: a white frame differs from a true positive, and edges stay visible."""
POINT_RADIUS = 2
"""Of a point's dot, px of the picture: larger dots would hide each other where hundreds lie on one car."""


class PointLabels(NamedTuple):
    """The labelled points seen in one frame.

    Attributes
    ----------
    points : float64 (N, 2)
        xy, px of a frame of `size`, pixel centres at integers.
    predicted, truth : uint16 (N,)
        Labels, 0 = static.
    size : (int, int)
        Height and width of the frame in which the points were labelled, px.
    """

    points: np.ndarray
    predicted: np.ndarray
    truth: np.ndarray
    size: tuple[int, int]


def draw_errors(image: np.ndarray, labels: np.ndarray, truth: np.ndarray, void: int | None = None) -> np.ndarray:
    """Colour what moves, in the labels or in truth, over the frame in dim grey.

    All moving objects are one, as in J: which object a pixel belongs to does not count.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    labels, truth : unsigned integer (y, x)
        0 = static.
    void : int, optional
        Label of `truth` that counts for neither side: these pixels are left uncoloured.

    Returns
    -------
    uint8 (y, x, rgb)

    References
    ----------
    Okabe, Ito, "Color Universal Design: How to make figures and presentations that are friendly to colorblind people",
    2008.
    """
    dim = (DIMMING * cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)).astype(np.float32)
    drawn = np.repeat(dim[..., None], 3, axis=-1)
    masks = sort_errors(labels, truth)
    counts = np.ones(truth.shape, dtype=bool) if void is None else truth != void
    for kind, colour in ERROR_COLOURS.items():
        mask = masks[kind] & counts
        drawn[mask] = (1 - OPACITY) * drawn[mask] + OPACITY * np.array(colour, np.float32)
    return np.rint(drawn).astype(np.uint8)


def draw_point_errors(image: np.ndarray, labelled: PointLabels) -> np.ndarray:
    """Draw a dot at each point that moves, in the prediction or in truth, over the frame in dim grey.

    Colours are those of `draw_errors`. A point that is static in both has no dot, and errors lie above correct points.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
        At any size.
    labelled : PointLabels

    Returns
    -------
    uint8 (y, x, rgb)
    """
    nothing = np.zeros(image.shape[:2], np.uint16)
    drawn = draw_errors(image, nothing, nothing)
    height, width = labelled.size
    scale = image.shape[1] / width, image.shape[0] / height
    centres = np.rint((labelled.points + 0.5) * scale - 0.5).astype(int)
    kinds = sort_errors(labelled.predicted, labelled.truth)
    for kind, colour in ERROR_COLOURS.items():
        for x, y in centres[kinds[kind]].tolist():
            cv2.circle(drawn, (x, y), POINT_RADIUS, colour, cv2.FILLED)
    return drawn


def sort_errors(labels: np.ndarray, truth: np.ndarray) -> dict[str, np.ndarray]:
    """Return where each kind of `ERROR_COLOURS` is, bool of the shape of `labels` and `truth`, both 0 = static."""
    predicted, moves = labels > 0, truth > 0
    return {
        "true positive": predicted & moves,
        "false positive": predicted & ~moves,
        "false negative": ~predicted & moves,
    }
