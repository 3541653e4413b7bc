"""Merging pieces of trajectories step by step so that the energy stays least."""

from itertools import combinations

import numpy as np

from moseg.tasks.trajectories.energy import Energy


def merge_by_energy(pieces: np.ndarray, energy: Energy, num_tried: int) -> dict[int, np.ndarray]:
    """Groupings of the pieces into every number of groups down to one.

    Each step merges the two groups whose union has the least energy, of the `num_tried` pairs whose union has the least
    normalised cut: fits are only made for groups that something holds together. What is merged by affinity alone
    depends on the hypotheses that happened to be drawn; this leads to nearly the same groupings from any draw.

    Parameters
    ----------
    pieces : int (N,)
        0 .. P - 1, each in use.
    energy : Energy
    num_tried : int

    Returns
    -------
    dict of int to int (N,)
        Labels 0 .. K - 1 for each number of groups K = P .. 1.
    """
    labels, found = pieces, {}
    while True:
        count = int(labels.max()) + 1
        found[count] = labels
        if count == 1:
            return found
        unions = [_merge(labels, *pair) for pair in combinations(range(count), 2)]
        cuts = np.array([energy.cut(union) for union in unions])
        nearest = np.argsort(cuts, kind="stable")[:num_tried]
        labels = energy.least([unions[index] for index in nearest]).labels


def _merge(labels: np.ndarray, first: int, second: int) -> np.ndarray:
    """Labels without a gap after the second group has joined the first, which comes before it."""
    merged = np.where(labels == second, first, labels)
    return merged - (merged > second)
