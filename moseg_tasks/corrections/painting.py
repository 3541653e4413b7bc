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
    """What an edit does with its pixels.

    Attributes
    ----------
    number : int
        Number of its strokes; see `steps_of`. 0 in one that erases whatever is there.
    erases : bool
        Whether it erases, else paints.
    same : tuple of int
        Numbers of earlier strokes that are the same object by now, for one that erases an object.
    """

    number: int
    erases: bool = False
    same: tuple[int, ...] = ()


class PaintedPixels(NamedTuple):
    """Outcome of the edits of a section.

    Attributes
    ----------
    painted : int32 (T, y, x)
        Number of the strokes on each pixel, `ERASED`, `UNTOUCHED`, or ``UNTOUCHED - n`` where only the objects of the
        n-th entry of `erased` are erased.
    erased : tuple of tuple of int
        Numbers of strokes, which stand for objects.
    """

    painted: np.ndarray
    erased: tuple[tuple[int, ...], ...]


def brushes_of(edits: Sequence[Edit]) -> dict[int, Brush]:
    """Return the brush of each edit that has pixels, by the index of the edit."""
    brushes: dict[int, Brush] = {}
    identities: dict[int, set[int]] = {}  # what the strokes of each number may be by now
    for index, step in enumerate(steps_of(edits)):
        if step.kind == "merge":
            for found in identities.values():
                found |= {step.objects[0]} if found & set(step.objects) else set()
        elif step.kind == "split":
            for found in identities.values():
                found |= {step.into} - {None} if step.objects[0] in found else set()
        elif step.kind in STROKES:
            number, same = step.number or 0, ()
            if step.kind == "erase" and number:
                same = tuple(each for each, found in identities.items() if step.objects[0] in found)
            elif number:
                identities.setdefault(number, {step.objects[0]})
            brushes[index] = Brush(number, step.kind == "erase", same)
    return brushes


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
            part[mask] = _erase_object(part[mask], brush, erased)
    return PaintedPixels(painted, tuple(erased))


def _erase_object(under: np.ndarray, brush: Brush, erased: list[tuple[int, ...]]) -> np.ndarray:
    """Return painted pixels, int32 (pixel,), after one object was erased there."""
    after = under.copy()
    after[np.isin(under, (brush.number, *brush.same))] = ERASED
    for value in np.unique(under[under < 0]).tolist():
        before = () if value == UNTOUCHED else erased[UNTOUCHED - 1 - value]
        objects = tuple(sorted({*before, brush.number}))
        if objects not in erased:
            erased.append(objects)
        after[under == value] = UNTOUCHED - 1 - erased.index(objects)
    return after
