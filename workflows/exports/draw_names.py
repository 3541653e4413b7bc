"""Numbers and names of objects, written on frames of an overlay."""

from collections.abc import Mapping
from functools import cache, lru_cache

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

LONGEST = 24
"""Characters of a label; a longer one is cut."""
ELLIPSIS = "…"
# Of the frame's height, and the smallest legible height, px.
_TEXT_SHARE, _MIN_TEXT = 1 / 18, 12
# Of the text's height: white with a dark rim is legible on every colour.
_STROKE_SHARE = 1 / 10
# Bold, 100 to 1000.
_WEIGHT = 600
# A character of Unicode that never has a glyph.
_NO_CHARACTER = "\uffff"


def draw_names(image: np.ndarray, labels: np.ndarray, names: Mapping[int, str]) -> np.ndarray:
    """Write the number of each object, and its name if it has one, at the mean of its pixels, inside the frame.

    A name with a character that the font does not have is left out: the number alone stands there.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    labels : uint16 (y, x)
        0 = static, else an identity.
    names : dict of int to str
        By identity.

    Returns
    -------
    uint8 (y, x, rgb)
    """
    size = max(_MIN_TEXT, round(labels.shape[0] * _TEXT_SHARE))
    stroke = max(1, round(size * _STROKE_SHARE))
    drawn = image.copy()
    y, x = np.nonzero(labels)
    identities = labels[y, x]
    areas = np.bincount(identities)
    sums = np.bincount(identities, weights=y), np.bincount(identities, weights=x)
    for identity in np.flatnonzero(areas).tolist():
        written = _draw_text(label_of(identity, names.get(identity)), size, stroke)
        _put(drawn, written, [total[identity] / areas[identity] for total in sums])
    return drawn


def label_of(identity: int, name: str | None) -> str:
    """Return the text for an object: its number, and its name if the font has all characters of that."""
    if not name or not all(map(_has_glyph, name)):
        return str(identity)
    text = f"{identity} {name}"
    return text if len(text) <= LONGEST else text[: LONGEST - len(ELLIPSIS)].rstrip() + ELLIPSIS


def _put(drawn: np.ndarray, written: tuple[np.ndarray, np.ndarray], centre: list[float]) -> None:
    """Write white text with a dark rim, in place, as near to a centre (y, x) as the frame has room for it."""
    ink, rim = (cover[: drawn.shape[0], : drawn.shape[1], None] for cover in written)
    first = [
        round(min(max(at - side / 2, 0), whole - side))
        for at, side, whole in zip(centre, ink.shape[:2], drawn.shape[:2], strict=True)
    ]
    part = drawn[first[0] : first[0] + ink.shape[0], first[1] : first[1] + ink.shape[1]]
    part[:] = np.rint((part * (1 - rim)) * (1 - ink) + 255 * ink).astype(np.uint8)


@lru_cache(maxsize=1024)
def _draw_text(text: str, size: int, stroke: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how much of each pixel a text covers, and the same of the text with its rim, float32 (y, x), 0..1."""
    ink = np.pad(_cover(text, size), stroke)
    brush = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * stroke + 1, 2 * stroke + 1))
    return ink / np.float32(255), cv2.dilate(ink, brush) / np.float32(255)


def _cover(text: str, size: int) -> np.ndarray:
    """Return the pixels that a text covers, uint8 (y, x), without empty rows and columns around it."""
    room = np.zeros((3 * size, (len(text) + 2) * 2 * size), np.uint8)
    if _has_unicode_font():
        cv2.putText(room, text, (size, 2 * size), (255,), cv2.FontFace("uni"), size, _WEIGHT)
    else:
        canvas = Image.fromarray(room)
        ImageDraw.Draw(canvas).text((size, size), text, 255, default_font(size))
        room = np.asarray(canvas)
    x, y, width, height = cv2.boundingRect(room)
    return room[y : y + height, x : x + width]


def _has_unicode_font() -> bool:
    """Return whether OpenCV has fonts: from version 5 on, with the characters of most languages."""
    return hasattr(cv2, "FontFace")


@lru_cache(maxsize=4096)
def _has_glyph(character: str) -> bool:
    """Return whether the font has a character; what it lacks is drawn as one that no font has."""
    if character in (" ", "?"):
        return True
    return character.isprintable() and not np.array_equal(*(_cover(each, 24) for each in (character, _missing())))


@cache
def _missing() -> str:
    return "?" if _has_unicode_font() else _NO_CHARACTER


@cache
def default_font(size: int) -> ImageFont.FreeTypeFont:
    """Return the font that comes with Pillow, the same on every machine."""
    return ImageFont.load_default(size)
