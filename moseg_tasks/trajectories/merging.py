"""Greedy merging of pieces of trajectories by energy."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from moseg.tasks.trajectories.energy import Energy
from moseg.tasks.trajectories.joint_searches import Search, run_together


def merge_by_energy(
    oversegmentations: Sequence[np.ndarray], energy: Energy, num_tried: int
) -> list[dict[int, np.ndarray]]:
    """Group the pieces of each over-segmentation into every number of groups down to one.

    Each step merges the two groups whose union has the smallest energy, among the `num_tried` pairs whose union has the
    smallest normalised cut: only groups with some affinity are fitted. A merge by affinity alone depends on the drawn
    hypotheses; merging by energy gives nearly the same groupings for any draw.

    Parameters
    ----------
    oversegmentations : sequence of int (N,)
        Pieces 0 .. P - 1, each in use.
    energy : Energy
    num_tried : int

    Returns
    -------
    list of dict of int to int (N,)
        Labels 0 .. K - 1 for each number of groups K = P .. 1 of an over-segmentation.
    """
    return run_together([_merge_all(pieces, energy, num_tried) for pieces in oversegmentations], energy.prepare)


def merge_pairs(labels: np.ndarray) -> list[np.ndarray]:
    """Return labels int (N,), 0 .. K - 1, with each pair of groups merged: K (K - 1) / 2 of 0 .. K - 2."""
    return [_merge(labels, *pair) for pair in combinations(range(int(labels.max()) + 1), 2)]


def _merge_all(pieces: np.ndarray, energy: Energy, num_tried: int) -> Search[dict[int, np.ndarray]]:
    """Merge the pieces of one over-segmentation."""
    labels, found = pieces, {}
    while True:
        count = int(labels.max()) + 1
        found[count] = labels
        if count == 1:
            return found
        pairs = list(combinations(range(count), 2))
        nearest = np.argsort(_cuts_of_unions(energy.group_affinities(labels), pairs), kind="stable")[:num_tried]
        best = yield from energy.search_below(np.inf, [_merge(labels, *pairs[index]) for index in nearest])
        labels = best.labels


def _cuts_of_unions(affinities: np.ndarray, pairs: list[tuple[int, int]]) -> np.ndarray:
    """Return the normalised cut after each merge of two groups, less what is the same for all merges."""
    first, second = np.array(pairs).T
    inside, degrees = np.diag(affinities), affinities.sum(axis=1)
    share = np.divide(inside, degrees, out=np.zeros_like(inside), where=degrees > 0)
    both, total = inside[first] + inside[second] + 2 * affinities[first, second], degrees[first] + degrees[second]
    united = np.divide(both, total, out=np.zeros_like(both), where=total > 0)
    return share[first] + share[second] - united


def _merge(labels: np.ndarray, first: int, second: int) -> np.ndarray:
    """Merge the second group into the first, whose label is smaller, and renumber the labels without a gap."""
    merged = np.where(labels == second, first, labels)
    return merged - (merged > second)
