"""Variants whose scores are the same: shown in one row, and a note of what that means."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

from moseg.schemas.configs import Variant
from moseg.schemas.scores import AnyScore

Value = TypeVar("Value")
MOST_NAMED = 5
"""Sequences that a note names."""


def group_equal(values: Mapping[str, Value]) -> dict[tuple[str, ...], Value]:
    """Return each value once, under the names that have it, in the order in which the values first occur.

    Scores of sequences of which one is missing are equal to none.
    """
    groups: list[tuple[list[str], Value]] = []
    for name, value in values.items():
        is_whole = not isinstance(value, Mapping) or None not in value.values()
        same = next((names for names, other in groups if is_whole and other == value), None)
        if same is None:
            groups.append(([name], value))
        else:
            same.append(name)
    return {tuple(names): value for names, value in groups}


def name_group(names: Sequence[str]) -> str:
    """Return the heading of variants in one row."""
    return ", ".join(names)


def equality_notes(scores: Mapping[str, Mapping[str, AnyScore | None]]) -> tuple[str, ...]:
    """Return what it means that variants have the same scores on all sequences, or on at least half of them.

    The variant ``base`` takes every proposal as moving: where all variants score as it does, only the proposals matter.
    """
    if len(scores) < 2:
        return ()
    by_name = {name: [each.get(name) for each in scores.values()] for name in next(iter(scores.values()))}
    if any(None in each for each in by_name.values()):
        return ()
    differing = [name for name, (first, *others) in by_name.items() if any(other != first for other in others)]
    if len(differing) * 2 > len(by_name):
        return ()
    meaning = "the proposals alone decide what moves" if Variant.BASE.value in scores else "their motion models agree"
    if not differing:
        *others, last = scores
        alike = f"{', '.join(others)} and {last} score the same on every sequence"
        return (f"{alike}: {meaning}",)
    named = ", ".join(differing[:MOST_NAMED]) + (", …" if len(differing) > MOST_NAMED else "")
    return (f"the variants differ on {len(differing)} of {len(by_name)} sequences ({named}); on the others {meaning}",)
