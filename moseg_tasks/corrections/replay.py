"""Replay of edits on the objects of a sequence: which there are then, and which of them each pixel belongs to."""

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from moseg.schemas.corrections import MAX_IDENTITY
from moseg.schemas.errors import InputError
from moseg.tasks.corrections.steps import STROKES, Step

MAX_SHOWN = 12
"""Identities that an error lists."""
Runs = list[tuple[int, int]]
"""First frame and identity of each run of frames, in order; the first run starts at 0."""
Members = list[tuple[int, int, int]]
"""Part of one object: object before the edits, or number of strokes; first frame; frame after the last."""


@dataclass(frozen=True)
class _State:
    """One object: its motion group, and whether it is one of the result."""

    motion: int
    is_shown: bool


class CorrectedObjects(NamedTuple):
    """Objects of a sequence after the edits.

    Attributes
    ----------
    motions : dict of int to int
        Motion group of each object by identity; 0 = the background's.
    shown : frozenset of int
        Identities of the objects of the result.
    runs : dict of int to list of (int, int)
        Identity over time, of each object that was there before the edits.
    stroke_runs : dict of int to list of (int, int)
        The same of each number of strokes.
    members : dict of int to list of (int, int, int)
        By number of strokes, the objects before the edits that were its object when the strokes were made, and in which
        frames. Merges and splits before the strokes count, later ones do not.
    stroke_members : dict of int to list of (int, int, int)
        The same of numbers of strokes, its own among them.
    """

    motions: dict[int, int]
    shown: frozenset[int]
    runs: dict[int, Runs]
    stroke_runs: dict[int, Runs]
    members: dict[int, Members]
    stroke_members: dict[int, Members]


def replay_steps(
    steps: Iterable[Step],
    motions: Mapping[int, int],
    num_frames: int,
    places: Sequence[str] = (),
    small: Container[int] = (),
) -> CorrectedObjects:
    """Apply steps one after the other.

    Parameters
    ----------
    steps : iterable of Step
    motions : mapping of int to int
        Motion group of each object by identity, before the edits; 0 = the background's.
    num_frames : int
        Frames of the sequence.
    places : sequence of str, optional
        Where each step stands, for errors.
    small : container of int
        Objects that move and are too small for the result, unless a step says otherwise.

    Raises
    ------
    InputError
        A step names an object that is not there, a number that is in use, or a frame that the sequence does not have.
    """
    objects = {identity: _State(group, group > 0 and identity not in small) for identity, group in motions.items()}
    runs = {identity: [(0, identity)] for identity in motions}
    stroke_runs: dict[int, Runs] = {}
    members: dict[int, Members] = {}
    stroke_members: dict[int, Members] = {}
    for index, step in enumerate(steps):
        where = places[index] if places else f"edit {index + 1} ({step.kind})"
        _check(step, objects, num_frames, where)
        if step.kind in STROKES:
            if step.kind != "erase" and step.objects[0] not in objects:
                objects[step.objects[0]] = _State(_next_motion(objects), is_shown=True)
            # What an object is made of changes with merges and splits, after which its strokes have another number.
            if step.number is not None and step.number not in stroke_runs:
                stroke_runs[step.number] = [(0, step.objects[0])]
                members[step.number] = _members(runs, step.objects[0], num_frames)
                stroke_members[step.number] = _members(stroke_runs, step.objects[0], num_frames)
        elif step.kind == "merge":
            objects[step.objects[0]] = _merged([objects[each] for each in step.objects])
            for each in step.objects[1:]:
                del objects[each]
            for table in (runs, stroke_runs):
                for key, found in table.items():
                    table[key] = _joined(found, step.objects)
        elif step.kind == "split":
            into = _free_number(objects, where) if step.into is None else step.into
            objects[into] = objects[step.objects[0]]
            for table in (runs, stroke_runs):
                for key, found in table.items():
                    table[key] = _cut(found, step.objects[0], step.frame, into)
        elif step.kind != "rename":
            objects[step.objects[0]] = _judged(step.kind, objects, step.objects[0])
    shown = frozenset(identity for identity, state in objects.items() if state.is_shown)
    motions = {identity: state.motion for identity, state in sorted(objects.items())}
    return CorrectedObjects(motions, shown, runs, stroke_runs, members, stroke_members)


def _check(step: Step, objects: Mapping[int, _State], num_frames: int, where: str) -> None:
    # Strokes may make a new object.
    for identity in () if step.kind in ("paint", "add") else step.objects:
        if identity not in objects:
            raise InputError("no such object", where=where, got=identity, expected=_listed(objects))
    if step.into is not None and step.into in objects:
        expected = f"a number not in use, such as {_free_number(objects, where)}"
        raise InputError("a number in use", where=where, got=step.into, expected=expected)
    if step.frame is not None and step.frame >= num_frames:
        raise InputError("no such frame", where=where, got=step.frame, expected=f"0 to {num_frames - 1}")


def _listed(objects: Iterable[int]) -> str:
    known = sorted(objects)
    if not known:
        return "none: nothing was found"
    more = f" and {len(known) - MAX_SHOWN} more" if len(known) > MAX_SHOWN else ""
    return f"one of {', '.join(map(str, known[:MAX_SHOWN]))}{more}"


def _free_number(objects: Iterable[int], where: str) -> int:
    number = max(objects, default=0) + 1
    if number > MAX_IDENTITY:
        number = next((each for each in range(1, MAX_IDENTITY) if each not in objects), None)
    if number is None:
        raise InputError("too many objects", where=where, expected=f"at most {MAX_IDENTITY}")
    return number


def _next_motion(objects: Mapping[int, _State]) -> int:
    return max((state.motion for state in objects.values()), default=0) + 1


def _judged(kind: str, objects: Mapping[int, _State], identity: int) -> _State:
    state = objects[identity]
    if kind == "drop":
        return replace(state, is_shown=False)
    if kind == "static":
        return _State(0, is_shown=False)
    if kind == "keep" and state.motion:
        return replace(state, is_shown=True)
    return _State(_next_motion(objects), is_shown=True)


def _merged(parts: Sequence[_State]) -> _State:
    """Return the state of objects that are one: that of the first of them that is in the result, else of the first."""
    return next((state for state in parts if state.is_shown), parts[0])


def _members(table: Mapping[int, Runs], identity: int, num_frames: int) -> Members:
    """Return which keys of a table are an identity, and in which frames."""
    members: Members = []
    for key, found in sorted(table.items()):
        stops = [*(first for first, _ in found[1:]), num_frames]
        members += [(key, first, stop) for (first, each), stop in zip(found, stops, strict=True) if each == identity]
    return members


def _joined(runs: Runs, merged: tuple[int, ...]) -> Runs:
    joined: Runs = []
    for first, identity in runs:
        identity = merged[0] if identity in merged else identity
        if not joined or joined[-1][1] != identity:
            joined.append((first, identity))
    return joined


def _cut(runs: Runs, identity: int, frame: int, into: int) -> Runs:
    """Return the runs of which those of an identity are another one from a frame on."""
    cut: Runs = []
    stops = [*(first for first, _ in runs[1:]), None]
    for (first, each), stop in zip(runs, stops, strict=True):
        if each != identity or (stop is not None and stop <= frame):
            cut.append((first, each))
        elif first >= frame:
            cut.append((first, into))
        else:
            cut += [(first, each), (frame, into)]
    return cut
