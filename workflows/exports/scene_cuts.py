"""Cuts of a video, over which no object is followed."""

from collections.abc import Container, Sequence

SHOWN = 8
"""Cuts that are named."""


def describe_cuts(frames: Sequence[int], apart: Container[int] = ()) -> tuple[str, ...]:
    """Return what cuts before `frames` mean for the result, in a line for each of both kinds; nothing without any.

    Parameters
    ----------
    frames : sequence of int
        Counted from 0.
    apart : container of int
        Those at which scenes were segmented apart.
    """
    between = [frame for frame in frames if frame in apart]
    within = [frame for frame in frames if frame not in apart]
    lines = []
    if between:
        lines.append(f"{_name(between)}: the scenes are segmented apart, and each object is in one of them")
    if within:
        them = "it" if len(within) == 1 else "them"
        told = f"objects are not followed over {them} reliably, and masks beside {them} are worse"
        lines.append(f"{_name(within)}: {told}; segment the scenes apart, with --start and --end")
    return tuple(lines)


def _name(frames: Sequence[int]) -> str:
    named = ", ".join(map(str, frames[:SHOWN]))
    rest = f" and {len(frames) - SHOWN} more" if len(frames) > SHOWN else ""
    return f"{'cut before frame' if len(frames) == 1 else 'cuts before frames'} {named}{rest}"
