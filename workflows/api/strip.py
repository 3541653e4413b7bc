"""Pictures of single frames on one sheet."""

from collections.abc import Mapping

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

COLUMNS = 3
GAP = 4
TEXT_SIZE = 14
PAPER, INK = (255, 255, 255), (32, 32, 32)


def spread_frames(num_frames: int, count: int) -> tuple[int, ...]:
    """Return at most `count` frames spread evenly from the first to the last; the middle one where `count` is 1."""
    if count == 1:
        return (num_frames // 2,)
    places = np.linspace(0, num_frames - 1, min(count, num_frames))
    return tuple(int(place) for place in np.rint(places))


def draw_strip(pictures: Mapping[int, np.ndarray], side: int) -> Image.Image:
    """Draw pictures uint8 (y, x, 3) of one size in rows, each with the number of its frame below.

    Parameters
    ----------
    pictures : mapping of int to array
        By frame, at least one.
    side : int
        Longer side of each in the sheet, px.
    """
    height, width = next(iter(pictures.values())).shape[:2]
    tile = tuple(max(1, round(extent * side / max(height, width))) for extent in (width, height))
    font = ImageFont.load_default(TEXT_SIZE)
    step_x, step_y = tile[0] + GAP, tile[1] + GAP + TEXT_SIZE + GAP
    columns = min(COLUMNS, len(pictures))
    rows = -(-len(pictures) // columns)
    sheet = Image.new("RGB", (columns * step_x - GAP, rows * step_y), PAPER)
    pen = ImageDraw.Draw(sheet)
    interpolation = cv2.INTER_AREA if side < max(height, width) else cv2.INTER_LINEAR
    for place, (frame, picture) in enumerate(pictures.items()):
        x, y = place % columns * step_x, place // columns * step_y
        sheet.paste(Image.fromarray(cv2.resize(picture, tile, interpolation=interpolation)), (x, y))
        pen.text((x, y + tile[1] + GAP), f"frame {frame}", INK, font, anchor="lt")
    return sheet
