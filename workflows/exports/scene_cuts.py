"""Cuts of a video, over which no object can be followed."""

from collections.abc import Sequence

SHOWN = 8
"""Cuts that are named."""


def describe_cuts(frames: Sequence[int]) -> tuple[str, ...]:
    """Return what is to be done about cuts before `frames`, counted from 0, in one line; nothing without any."""
    if not frames:
        return ()
    named = ", ".join(map(str, frames[:SHOWN]))
    rest = f" and {len(frames) - SHOWN} more" if len(frames) > SHOWN else ""
    cuts, them = ("cut before frame", "it") if len(frames) == 1 else ("cuts before frames", "them")
    told = f"objects are not followed over {them} reliably, and masks beside {them} are worse"
    return (f"{cuts} {named}{rest}: {told}; segment the scenes apart, with --start and --end",)
