"""Painted and erased pixels of a section, from its edits in their order."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.corrections import Edit
from moseg.tasks.corrections.relabel import UNTOUCHED
from moseg.tasks.corrections.steps import STROKES, steps_of

ERASED = 0
"""Painted label of a pixel that is no object."""


class Brush(NamedTuple):
    """Effect of an edit on its pixels.

    Attributes
    ----------
    number : int
        Number of its strokes; see `steps_of`. 0 in one that erases whatever is there.
    erases : bool
        Whether it erases, else paints.
    """

    number: int
    erases: bool = False


class PaintedPixels(NamedTuple):
    """Outcome of the edits of a section.

    Attributes
    ----------
    painted : int32 (T, y, x)
        Number of the strokes on each pixel, `ERASED`, `UNTOUCHED`, or ``UNTOUCHED - n`` where only the objects of the
        n-th entry of `erased` are erased, counted from 1.
    erased : tuple of tuple of int
        What is beneath, a number of strokes or `UNTOUCHED`, and then the numbers of the strokes that erase. Which
        objects these erase in which frame is known to the replay of all edits; see `CorrectedObjects.members`.
    """

    painted: np.ndarray
    erased: tuple[tuple[int, ...], ...]


def brushes_of(edits: Sequence[Edit]) -> dict[int, Brush]:
    """Return the brush of each edit that has pixels, by the index of the edit."""
    return {
        index: Brush(step.number or 0, step.kind == "erase")
        for index, step in enumerate(steps_of(edits))
        if step.kind in STROKES
    }


def paint_pixels(
    masks: Iterable[tuple[int, np.ndarray]], brushes: Sequence[Brush], shape: tuple[int, int, int]
) -> PaintedPixels:
    """Apply edits one after the other; a later one overrides those before it.

    Parameters
    ----------
    masks : iterable of (int, bool (t, y, x))
        First frame of the section that an edit reaches, and its pixels from there on.
    brushes : sequence of Brush
    shape : (T, y, x)
        Of the section.
    """
    painted = np.full(shape, UNTOUCHED, np.int32)
    erased: list[tuple[int, ...]] = []
    for (first, mask), brush in zip(masks, brushes, strict=True):
        part = painted[first : first + len(mask)]
        if not brush.erases:
            part[mask] = brush.number
        elif not brush.number:
            part[mask] = ERASED
        else:
            part[mask] = _erase_object(part[mask], brush.number, erased)
    return PaintedPixels(painted, tuple(erased))


def _erase_object(under: np.ndarray, number: int, erased: list[tuple[int, ...]]) -> np.ndarray:
    """Return painted pixels, int32 (pixel,), after one object was erased there."""
    after = under.copy()
    for value in np.unique(under[under != ERASED]).tolist():
        beneath, *before = (value,) if value >= UNTOUCHED else erased[UNTOUCHED - 1 - value]
        if beneath == number:
            after[under == value] = ERASED
            continue
        entry = (beneath, *sorted({*before, number}))
        if entry not in erased:
            erased.append(entry)
        after[under == value] = UNTOUCHED - 1 - erased.index(entry)
    return after
