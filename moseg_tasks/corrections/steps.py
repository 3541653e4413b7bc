"""Steps: what edits do to the objects of a result, without the pixels and the names that they bring."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from moseg.schemas.corrections import Edit, kind_of

AGE = 1 << 16
"""Distance of the numbers of an object's strokes before and after its merges and splits; no identity is as large."""
VERDICTS = ("drop", "keep", "static", "moving")
STROKES = ("paint", "erase", "add")


class Step(NamedTuple):
    """Effect of one edit on the objects.

    Attributes
    ----------
    kind : str
        That of the edit.
    objects : tuple of int
        Identities that it names; none for one that erases whatever is there.
    frame : int or None
        Frame from which a split applies, or of the strokes.
    into : int or None
        Object that a split makes; None for the next free number.
    number : int or None
        Number of the strokes in painted labels; see `steps_of`.
    """

    kind: str
    objects: tuple[int, ...]
    frame: int | None = None
    into: int | None = None
    number: int | None = None


def steps_of(edits: Iterable[Edit]) -> tuple[Step, ...]:
    """Return the step of each edit.

    An object that is merged or split later carries its strokes along; strokes after that are another matter. So strokes
    have a number of their own: the object's identity, plus `AGE` for every merge and split before them that names it.
    It depends on these alone, so that another edit leaves the painted labels of a section as they are.
    """
    steps, ages = [], {}
    for edit in edits:
        kind = kind_of(edit)
        value = getattr(edit, kind)
        if kind in VERDICTS:
            steps.append(Step(kind, (value,)))
        elif kind == "merge":
            steps.append(Step(kind, value))
        elif kind == "split":
            steps.append(Step(kind, (value.object,), value.frame, value.into))
        elif kind == "rename":
            steps.append(Step(kind, (value.object,)))
        elif value.object is None:
            steps.append(Step(kind, (), value.frame))
        else:
            number = value.object + AGE * ages.get(value.object, 0)
            steps.append(Step(kind, (value.object,), value.frame, number=number))
        if kind in ("merge", "split"):
            for each in steps[-1].objects:
                ages[each] = ages.get(each, 0) + 1
    return tuple(steps)


def recipe_steps(edits: Iterable[Edit]) -> list[dict[str, Any]]:
    """Return the steps that decide which object a pixel belongs to, as JSON; of strokes of one number the first alone.

    Names decide nothing; frames of strokes decide nothing here.
    """
    written: dict[int, None] = {}
    kept = []
    for step in steps_of(edits):
        if step.kind == "rename" or (step.kind in STROKES and (step.number is None or step.number in written)):
            continue
        if step.kind in STROKES:
            written[step.number] = None
            step = step._replace(frame=None)
        fields = step._replace(objects=list(step.objects))._asdict()
        kept.append({name: value for name, value in fields.items() if value is not None})
    return kept


def read_steps(values: Iterable[Mapping[str, Any]]) -> tuple[Step, ...]:
    """Return the steps of a recipe."""
    return tuple(Step(**{**value, "objects": tuple(value["objects"])}) for value in values)
