"""Frames of files, and frame pairs of files, found from their names."""

import re
from collections.abc import Collection, Sequence
from enum import StrEnum
from itertools import pairwise
from typing import NamedTuple

from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import natural_key, stem
from moseg.workflows.sources.frames import FrameSource
from moseg.workflows.sources.image_files import ImageFiles

_NUMBER = re.compile(r"[0-9]+")


class Matching(StrEnum):
    """How files were matched to frames: by the frames' names, in their order, or by the number in their names."""

    NAME = "name"
    ORDER = "order"
    NUMBER = "number"


class MatchedNames(NamedTuple):
    """The frame of each name, counted from 0, and the rule by which it was found."""

    matching: Matching
    frames: tuple[int, ...]


def frame_stems(frames: FrameSource) -> tuple[str, ...] | None:
    """Return the frames' names without suffix; None if frames are not files (a video, a rendered scene)."""
    return tuple(map(stem, frames.paths)) if isinstance(frames, ImageFiles) else None


def match_names(
    names: Sequence[str], stems: tuple[str, ...] | None, num_frames: int, where: object, by_pairs: bool = False
) -> MatchedNames:
    """Find the frame of each file of a sequence by one of three rules, the first that applies.

    1. By name: every name is that of a frame.
    2. In order: there are as many files as frames, and none has the name of a frame, or their numbers count up from 0
       or 1. Files in natural order are the frames in order. All of them have a number, or none has.
    3. By number: no name is that of a frame. The last number in a name is its frame, counted from 0.

    Parameters
    ----------
    names : sequence of str
        Names of the files, without suffix and without the format's additions.
    stems : tuple of str or None
        Names of the frames without suffix, if they have any.
    num_frames : int
        Frames of the sequence.
    where : object
        Folder of the files, for the error.
    by_pairs : bool
        One file fewer than frames is enough too, if the files' numbers count up: the last frame has none.

    Raises
    ------
    InputError
        Some names are those of frames and others are not; a number is not a frame's, is another frame's by the frames'
        own names, or is shared by two files.
    """
    index_of = {name: index for index, name in enumerate(stems or ())}
    if all(name in index_of for name in names):
        return MatchedNames(Matching.NAME, tuple(index_of[name] for name in names))
    in_order = sorted(names, key=natural_key)
    if _are_all_frames(in_order, index_of.keys(), num_frames, by_pairs):
        position = {name: index for index, name in enumerate(in_order)}
        return MatchedNames(Matching.ORDER, tuple(position[name] for name in names))
    check_not_mixed(in_order, index_of.keys(), f"{num_frames} files numbered from 0 or 1", where)
    return MatchedNames(Matching.NUMBER, _by_number(names, stems, num_frames, where))


def check_not_mixed(names: Sequence[str], stems: Collection[str], otherwise: str, where: object) -> None:
    """Raise InputError if some names are those of frames and others are not; `otherwise` is an alternative."""
    own = [name for name in names if name in stems]
    if 0 < len(own) < len(names):
        other = next(name for name in names if name not in stems)
        raise InputError(
            "files of which only some have the name of a frame",
            where=where,
            got=f"{own[0]}, which is a frame, and {other}, which is none",
            expected=f"the names of frames alone, or {otherwise}",
        )


def file_number(name: str) -> int | None:
    """Return the last number in a name; None if there is none."""
    numbers = _NUMBER.findall(name)
    return int(numbers[-1]) if numbers else None


def counts_up(names: Sequence[str], starts: Collection[int] | None = None) -> bool:
    """Return whether names are numbered without a gap, the first number being one of `starts`."""
    numbers = [file_number(name) for name in names]
    if None in numbers or (starts is not None and numbers[0] not in starts):
        return False
    return numbers == list(range(numbers[0], numbers[0] + len(numbers)))


def _are_all_frames(in_order: Sequence[str], stems: Collection[str], num_frames: int, by_pairs: bool) -> bool:
    """Return whether names in natural order are the frames in order."""
    is_one_short = by_pairs and len(in_order) == num_frames - 1
    if len(in_order) != num_frames and not is_one_short:
        return False
    if any(name in stems for name in in_order):
        return counts_up(in_order, starts=(0, 1))
    if is_one_short:
        return counts_up(in_order)
    # A name without a number among numbered ones is not a frame; 7 and 007 may be the same frame.
    are_alike = len({file_number(name) is None for name in in_order}) == 1
    return are_alike and all(natural_key(name0)[0] != natural_key(name1)[0] for name0, name1 in pairwise(in_order))


def _by_number(names: Sequence[str], stems: tuple[str, ...] | None, num_frames: int, where: object) -> tuple[int, ...]:
    """Return the last number of each name; raise InputError if it cannot be that of its frame."""
    named = {file_number(name): (index, name) for index, name in enumerate(stems or ())}
    found: dict[int, str] = {}
    for name in names:
        number = file_number(name)
        if number is None or number >= num_frames:
            expected = f"the name of a frame, or its number from 0 to {num_frames - 1}"
            raise InputError("file without a frame", where=where, got=name, expected=expected)
        if number in found:
            raise InputError(f"two files of frame {number}", where=where, got=f"{found[number]} and {name}")
        if number in named and named[number][0] != number:
            raise InputError(
                "a number that may mean two frames",
                where=where,
                got=f"{name}, which may be {named[number][1]} or, counted from 0, {stems[number]}",
                expected="the names of the frames",
            )
        found[number] = name
    return tuple(found)


def check_pairs(names: Sequence[str], stems: tuple[str, ...] | None, where: object) -> None:
    """Raise InputError if names show that the file of a pair of neighbouring frames is missing.

    Files may be named as the first frame of each pair or each as the second, or be numbered from 0 or 1. Other names
    show nothing, unless they are numbered in equal steps except for a gap.

    Parameters
    ----------
    names : sequence of str
        Names of the files without suffix, in natural order, one fewer than frames.
    stems : tuple of str or None
        Names of the frames without suffix, if they have any.
    where : object
        Folder of the files, for the error.
    """
    if not names:
        return
    own = stems or ()
    absent = set(own) - set(names)
    if len(own) - len(absent) == len(names):
        if absent.isdisjoint((own[0], own[-1])):
            expected = "one for each pair of neighbouring frames, named as its first"
            got = f"none named {absent.pop()}"
            raise InputError("a gap in the flow fields", where=where, got=got, expected=expected)
        return
    has_own = len(absent) < len(own)
    if counts_up(names, starts=(0, 1) if has_own else None):
        return
    check_not_mixed(names, own, f"{len(names)} files numbered from 0 or 1", where)
    steps = _steps(names)
    # If the frames' own numbers have gaps, those of the flow may have them too.
    if len(set(steps)) > 1 and len(set(_steps(own))) < 2:
        before, after = list(pairwise(names))[steps.index(max(steps))]
        expected = "one for each pair of neighbouring frames"
        raise InputError("a gap in the flow fields", where=where, got=f"{before}, then {after}", expected=expected)


def _steps(names: Sequence[str]) -> list[int]:
    """Return the differences between successive names' numbers; none if a name has no number."""
    numbers = [file_number(name) for name in names]
    return [] if None in numbers else [after - before for before, after in pairwise(numbers)]
