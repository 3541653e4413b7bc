"""Greedy merging of pieces of trajectories by energy."""

from itertools import combinations

import numpy as np

from moseg.tasks.trajectories.energy import Energy


def merge_by_energy(pieces: np.ndarray, energy: Energy, num_tried: int) -> dict[int, np.ndarray]:
    """Group the pieces into every number of groups down to one.

    Each step merges the two groups whose union has the smallest energy, among the `num_tried` pairs whose union has the
    smallest normalised cut: only groups with some affinity are fitted. A merge by affinity alone depends on the drawn
    hypotheses; merging by energy gives nearly the same groupings for any draw.

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
        labels = energy.minimum([unions[index] for index in nearest]).labels


def _merge(labels: np.ndarray, first: int, second: int) -> np.ndarray:
    """Merge the second group into the first, whose label is smaller, and renumber the labels without a gap."""
    merged = np.where(labels == second, first, labels)
    return merged - (merged > second)
