"""Contact sheet of prompts: boxes and points of moving regions, and the outlines of true objects."""

import cv2
import numpy as np
from hits import PromptedFrame
from PIL import Image, ImageDraw

from moseg.workflows.exports.draw_contact_sheet import GAP, HEAD_SIZE, INK, MARGIN, PAPER, TEXT_SIZE
from moseg.workflows.exports.draw_names import default_font
from moseg.workflows.exports.palette import identity_colours

TILE_WIDTH = 640
COLUMNS = 3
TRUE_OUTLINE = (255, 255, 255)
TINT = 0.35


def draw_sheet(name: str, frames: list[PromptedFrame]) -> np.ndarray:
    """Return a picture of the prompted frames of a sequence, uint8 (y, x, rgb).

    Each region has a colour, in which its pixels are tinted and its box and its points are drawn; a cross is a point
    outside of all true objects. True objects are outlined in white.
    """
    tiles = [draw_prompts(frame) for frame in frames]
    height, width = tiles[0].shape[:2] if tiles else (0, 0)
    columns = min(COLUMNS, max(len(tiles), 1))
    rows = -(-len(tiles) // columns)
    line = TEXT_SIZE + 6
    top = 2 * MARGIN + HEAD_SIZE
    size = (2 * MARGIN + columns * (width + GAP), top + rows * (height + line + GAP) + MARGIN)
    sheet = Image.new("RGB", size, PAPER)
    pen = ImageDraw.Draw(sheet)
    pen.text((MARGIN, MARGIN), name, INK, default_font(HEAD_SIZE), anchor="lt")
    for index, (frame, tile) in enumerate(zip(frames, tiles, strict=True)):
        row, column = divmod(index, columns)
        x, y = MARGIN + column * (width + GAP), top + row * (height + line + GAP)
        pen.text((x, y), f"frame {frame.frame}", INK, default_font(TEXT_SIZE), anchor="lt")
        sheet.paste(Image.fromarray(tile), (x, y + line))
    return np.asarray(sheet)


def draw_prompts(frame: PromptedFrame) -> np.ndarray:
    """Return a frame with its prompts, uint8 (y, x, rgb), `TILE_WIDTH` px wide."""
    height, width = frame.image.shape[:2]
    scale = TILE_WIDTH / width
    shape = (TILE_WIDTH, round(height * scale))
    drawn = cv2.resize(frame.image, shape, interpolation=cv2.INTER_AREA)
    labels = cv2.resize(frame.prompts.labels, shape, interpolation=cv2.INTER_NEAREST)
    tinted = (1 - TINT) * drawn + TINT * identity_colours(labels)
    drawn = np.where(labels[..., None] > 0, tinted, drawn).astype(np.uint8)
    if frame.truth is not None:
        for label in frame.objects:
            mask = cv2.resize((frame.truth == label).astype(np.uint8), shape, interpolation=cv2.INTER_NEAREST)
            outlines, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
            cv2.drawContours(drawn, outlines, -1, TRUE_OUTLINE, 1)
    rows = zip(frame.prompts.boxes, frame.prompts.points, frame.owners, strict=True)
    for number, (box, points, owners) in enumerate(rows, start=1):
        colour = tuple(identity_colours(np.array(number)).tolist())
        left, top, right, bottom = (round(float(side) * scale) for side in box)
        cv2.rectangle(drawn, (left, top), (right, bottom), colour, 2)
        for point, owner in zip(points, owners, strict=True):
            centre = tuple(round(float(place) * scale) for place in point)
            if owner:
                cv2.circle(drawn, centre, 6, (0, 0, 0), cv2.FILLED)
                cv2.circle(drawn, centre, 4, colour, cv2.FILLED)
            else:
                cv2.drawMarker(drawn, centre, (0, 0, 0), cv2.MARKER_TILTED_CROSS, 14, 5)
                cv2.drawMarker(drawn, centre, colour, cv2.MARKER_TILTED_CROSS, 12, 2)
    return drawn
