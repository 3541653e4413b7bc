"""Splits of groups of trajectories along pieces."""

import numpy as np

from moseg.tasks.trajectories.energy import Energy, Grouping

_MIN_TRACKS = 8
"""Trajectories of a part; fewer have any fundamental matrix, and cost nothing."""


def split_grouping(grouping: Grouping, energy: Energy, pieces: np.ndarray, num_tried: int) -> list[Grouping]:
    """Return the groupings with one group more, the part of a piece in one group, in the order of their energy.

    Parameters
    ----------
    grouping : Grouping
        Its labels are 0 .. K - 1, each in use.
    energy : Energy
    pieces : int (N,)
        An over-segmentation.
    num_tried : int
        Largest number of groupings returned, those of the lowest energy without the coding length, which takes the
        most time.
    """
    labels = grouping.labels
    sizes = np.bincount(labels)
    parts = pieces * len(sizes) + labels
    split = []
    for part, size in zip(*np.unique(parts, return_counts=True), strict=True):
        left = sizes[part % len(sizes)] - size
        if min(size, left) >= _MIN_TRACKS:
            split.append(np.where(parts == part, len(sizes), labels))
    return energy.rank(energy.most_promising(split, num_tried))
