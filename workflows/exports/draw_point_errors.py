"""Where a mask is right and where it is wrong at labelled points, drawn over the frame."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.workflows.exports.draw_errors import ERROR_COLOURS, draw_errors, sort_errors

POINT_RADIUS = 2
"""Of a point's dot, px of the picture: larger ones would hide each other where hundreds lie on one car."""


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


def draw_point_errors(image: np.ndarray, labelled: PointLabels) -> np.ndarray:
    """A dot at each point that moves, in the prediction or in truth, over the frame in dim grey.

    Colours are those of `draw_errors`. A point that is static in both has no dot, and errors lie above what is right.

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
