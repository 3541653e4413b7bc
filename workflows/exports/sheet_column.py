"""The pictures of one frame in a contact sheet: frame, soft map, mask and errors."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.workflows.exports.colour_maps import colour_soft_map
from moseg.workflows.exports.draw_errors import draw_errors
from moseg.workflows.exports.draw_labels import draw_labels
from moseg.workflows.exports.draw_point_errors import PointLabels, draw_point_errors
from moseg.workflows.sources.resize import resize_labels

TILE_SIDE = 320
"""Longer side of a frame in a sheet, px: eight of them are as wide as a large screen."""


class SheetFrame(NamedTuple):
    """One frame of a sequence and what was found in it.

    Attributes
    ----------
    index : int
        Counted from 0.
    image : uint8 (y, x, rgb)
    labels : uint16 (y, x)
        0 = static, else an identity.
    soft_map : float32 (h, w) or None
        How sure it is that a pixel moves, 0..1, at any size.
    truth : unsigned integer (y, x) or None
        Ground truth at any size.
    J : float or None
        Region similarity of the frame's moving pixels, or of its labelled points, percent.
    labelled : PointLabels or None
        Ground truth at points, where there is none at every pixel.
    """

    index: int
    image: np.ndarray
    labels: np.ndarray
    soft_map: np.ndarray | None = None
    truth: np.ndarray | None = None
    J: float | None = None
    labelled: PointLabels | None = None

    @property
    def caption(self) -> str:
        """What stands above the frame."""
        return f"frame {self.index}" + ("" if self.J is None else f"   J {self.J:.1f}")


def draw_column(frame: SheetFrame, soft_title: str, void: int | None = None) -> dict[str, np.ndarray]:
    """Pictures of a frame by their row's title, uint8 (y, x, rgb), all of one size.

    Parameters
    ----------
    frame : SheetFrame
    soft_title : str
        Title of the row of soft maps.
    void : int, optional
        True label that counts for neither side.
    """
    shape = tile_shape(frame.image.shape[:2])
    image = _resize(frame.image, shape)
    tiles = {"frame": image}
    if frame.soft_map is not None:
        tiles[soft_title] = colour_soft_map(_resize(frame.soft_map, shape))
    # Drawn at the tile's size: the outline keeps its width.
    tiles["mask"] = draw_labels(image, resize_labels(frame.labels, shape))
    if frame.truth is not None:
        # Drawn at the frame's size and reduced: a thin error fades, where nearest neighbours might skip it.
        truth = resize_labels(frame.truth, frame.image.shape[:2])
        tiles["errors"] = _resize(draw_errors(frame.image, frame.labels, truth, void), shape)
    elif frame.labelled is not None:
        tiles["errors"] = draw_point_errors(image, frame.labelled)
    return tiles


def tile_shape(shape: tuple[int, int]) -> tuple[int, int]:
    """Height and width, px, at which frames of a shape stand in a sheet."""
    return tuple(max(1, round(side * TILE_SIDE / max(shape))) for side in shape)


def _resize(image: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    height, width = shape
    interpolation = cv2.INTER_AREA if height < image.shape[0] else cv2.INTER_LINEAR
    return cv2.resize(image, (width, height), interpolation=interpolation)
