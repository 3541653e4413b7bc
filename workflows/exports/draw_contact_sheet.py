"""Contact sheet: frames of a sequence side by side, and below each frame what was found in it."""

from collections.abc import Iterable
from typing import NamedTuple

import cv2
import numpy as np
from PIL import Image, ImageDraw

from moseg.workflows.exports.colour_maps import SOFT_COLOURS, colour_soft_map, draw_colour_bar
from moseg.workflows.exports.draw_errors import ERROR_COLOURS, PointLabels, draw_errors, draw_point_errors
from moseg.workflows.exports.draw_names import default_font
from moseg.workflows.exports.draw_overlay import draw_labels
from moseg.workflows.sources.resize import resize_labels

PAPER, INK = (255, 255, 255), (32, 32, 32)
MARGIN, GAP = 16, 6
HEAD_SIZE, TEXT_SIZE = 28, 18
TITLES_WIDTH = 156
"""Width of the titles left of the rows, px: the longest line of a legend, "false negative", beside its colour."""
MIN_TILE = (102, 150)
"""Minimum height and width of a tile's cell, px: a legend of three lines, and the longest caption."""
_LINE = TEXT_SIZE + 6
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
        Confidence that a pixel moves, 0..1, at any size.
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
        """Text above the frame."""
        return f"frame {self.index}" + ("" if self.J is None else f"   J {self.J:.1f}")


def draw_contact_sheet(
    head: str, frames: Iterable[SheetFrame], soft_title: str = "saliency", void: int | None = None
) -> np.ndarray:
    """Draw frames as columns; the rows are frame, soft map, mask and errors, as far as the frames have them.

    Parameters
    ----------
    head : str
        Line above everything.
    frames : iterable of SheetFrame
        At least one; all of one size and with the same pictures.
    soft_title : str
        Title of the row of soft maps.
    void : int, optional
        True label that counts for neither side.

    Returns
    -------
    uint8 (y, x, rgb)
    """
    captions, columns = [], []
    for frame in frames:
        captions.append(frame.caption)
        columns.append(draw_column(frame, soft_title, void))
    titles = list(columns[0])
    shape = columns[0]["frame"].shape[:2]
    row_height, column_width = (max(side, minimum) for side, minimum in zip(shape, MIN_TILE, strict=True))
    first_x, first_y = MARGIN + TITLES_WIDTH, MARGIN + HEAD_SIZE + 2 * GAP + _LINE
    step_x, step_y = column_width + GAP, row_height + GAP
    width = max(first_x + len(columns) * step_x - GAP, MARGIN + round(default_font(HEAD_SIZE).getlength(head))) + MARGIN
    sheet = Image.new("RGB", (width, first_y + len(titles) * step_y - GAP + MARGIN), PAPER)
    pen = ImageDraw.Draw(sheet)
    pen.text((MARGIN, MARGIN), head, INK, default_font(HEAD_SIZE), anchor="lt")
    for row, title in enumerate(titles):
        _draw_title(sheet, pen, (MARGIN, first_y + row * step_y), title, soft_title)
    for index, (caption, tiles) in enumerate(zip(captions, columns, strict=True)):
        x = first_x + index * step_x
        pen.text((x, first_y - GAP), caption, INK, default_font(TEXT_SIZE), anchor="ls")
        for row, tile in enumerate(tiles.values()):
            sheet.paste(Image.fromarray(tile), (x, first_y + row * step_y))
    return np.asarray(sheet)


def draw_column(frame: SheetFrame, soft_title: str, void: int | None = None) -> dict[str, np.ndarray]:
    """Draw the pictures of a frame by their row's title, uint8 (y, x, rgb), all of one size.

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
    """Return height and width, px, of a frame in a sheet."""
    return tuple(max(1, round(side * TILE_SIDE / max(shape))) for side in shape)


def _draw_title(
    sheet: Image.Image, pen: ImageDraw.ImageDraw, corner: tuple[int, int], title: str, soft_title: str
) -> None:
    """Draw a row's title and, below it, the meaning of its colours."""
    x, y = corner
    font = default_font(TEXT_SIZE)
    pen.text((x, y), title, INK, font, anchor="lt")
    y += _LINE
    if title == soft_title:
        length = TITLES_WIDTH - 2 * MARGIN
        scale = draw_colour_bar((TEXT_SIZE, length), SOFT_COLOURS)
        sheet.paste(Image.fromarray(scale), (x, y))
        y += _LINE
        pen.text((x, y), "0", INK, font, anchor="lt")
        pen.text((x + length, y), "1", INK, font, anchor="rt")
    elif title == "errors":
        for kind, colour in ERROR_COLOURS.items():
            pen.rectangle((x, y, x + TEXT_SIZE - 2, y + TEXT_SIZE - 2), colour, INK)
            pen.text((x + TEXT_SIZE + 4, y + TEXT_SIZE // 2), kind, INK, font, anchor="lm")
            y += _LINE


def _resize(image: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    height, width = shape
    interpolation = cv2.INTER_AREA if height < image.shape[0] else cv2.INTER_LINEAR
    return cv2.resize(image, (width, height), interpolation=interpolation)
