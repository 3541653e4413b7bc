"""Whether files of frame pairs, taken in order, are those of all pairs."""

from collections.abc import Sequence
from itertools import pairwise

from moseg.schemas.errors import InputError
from moseg.workflows.sources.frame_matching import check_not_mixed, counts_up, file_number


def check_pairs(names: Sequence[str], stems: tuple[str, ...] | None, where: object) -> None:
    """Raise InputError where names show that a file of some pair of neighbouring frames is missing.

    Files may be named as the first frame of each pair or each as the second, or be numbered from 0 or 1. Other names
    tell nothing, unless they are numbered in equal steps but for a gap.

    Parameters
    ----------
    names : sequence of str
        Names of the files without suffix, in natural order, one fewer than frames.
    stems : tuple of str or None
        Names of the frames without suffix, where they have any.
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
    # Frames that are numbered with gaps themselves may have flow that is numbered so too.
    if len(set(steps)) > 1 and len(set(_steps(own))) < 2:
        before, after = list(pairwise(names))[steps.index(max(steps))]
        expected = "one for each pair of neighbouring frames"
        raise InputError("a gap in the flow fields", where=where, got=f"{before}, then {after}", expected=expected)


def _steps(names: Sequence[str]) -> list[int]:
    """Differences between the numbers of names that follow each other; none where a name has no number."""
    numbers = [file_number(name) for name in names]
    return [] if None in numbers else [after - before for before, after in pairwise(numbers)]
