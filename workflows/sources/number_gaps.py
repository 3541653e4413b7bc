"""Gaps in the numbers of image files, which show that frames are missing."""

import os
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

from moseg.workflows.sources.files import stem
from moseg.workflows.sources.frame_matching import file_number

MOST_NAMED = 5
"""Gaps that a note names."""


def gap_notes(paths: Sequence[str]) -> tuple[str, ...]:
    """Return a note that names the missing frames of a folder, or none.

    Numbers are the last ones in the names. They may count in any equal steps (0, 5, 10): most pairs of neighbours have
    the usual step, or else numbers are not counts (time stamps) and show no gap.
    """
    gaps = find_gaps([file_number(stem(path)) for path in paths])
    if not gaps:
        return ()
    named = ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in gaps[:MOST_NAMED])
    more = f" and {len(gaps) - MOST_NAMED} further gaps" if len(gaps) > MOST_NAMED else ""
    one = len(gaps) == 1 and gaps[0][0] == gaps[0][1]
    missing = f"frame{'' if one else 's'} {named}{more} missing in {os.path.dirname(paths[0])}"
    return (f"{missing}: the frames beside a gap are taken as neighbours, and motion between them is larger",)


def find_gaps(numbers: Sequence[int | None]) -> tuple[tuple[int, int], ...]:
    """Return the first and the last missing number of each gap; none if the numbers do not count in equal steps."""
    if None in numbers or len(numbers) < 3:
        return ()
    steps = [after - before for before, after in pairwise(numbers)]
    step, count = min(Counter(steps).items(), key=lambda item: (-item[1], item[0]))
    if step < 1 or count * 2 <= len(steps):
        return ()
    gaps = [(before + step, after - step) for before, after in pairwise(numbers) if after - before > step]
    # A number between two steps is no gap of whole frames.
    return tuple((first, last) for first, last in gaps if first <= last)
