"""Groupings of trajectories worth considering, for any number of motions."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.tasks.clustering.kmeans import cluster_many_points
from moseg.tasks.clustering.spectral import leading_eigenpairs, normalise_affinity, unit_rows
from moseg.tasks.trajectories.pieces import link_pieces, piece_affinity


class View(NamedTuple):
    """What one model says of N trajectories in one draw of hypotheses."""

    kernel: np.ndarray
    """float32 (N, N): sparsified ordered residual kernel."""
    residual: np.ndarray | None
    """float16 (S, H, N): px. Read where groupings compete by energy."""


class _Oversegmentation(NamedTuple):
    """Pieces int (N,), and how each affinity merges them: groups int (P, P), [number of groups - 1, piece]."""

    pieces: np.ndarray
    groups: tuple[np.ndarray, ...]


class Candidates:
    """Groupings from one draw of hypotheses, by spectral clustering and by merging of over-segmentations.

    Spectral clustering into the number of motions often cuts the background, the largest group, before it tells a small
    mover apart. Into more clusters than there are motions it errs by a percent or two: such pieces lie on one moving
    surface. What they are then merged by, the hypotheses that a piece's median residual prefers, is far more certain
    than the same of single trajectories. Where one set of views or one number of pieces fails, another does not; which
    grouping is right is then a matter of its energy.

    Parameters
    ----------
    views : sequence of View
        One for each model, from the least general to the most.
    most_motions : int
        Largest number of motions that will be asked for, at most N.
    params : TrajectoryClusteringParams
    seed : int
        Starts k-means.
    """

    def __init__(self, views: Sequence[View], most_motions: int, params: TrajectoryClusteringParams, seed: int):
        self._num_starts = params.num_starts
        self._seed = seed
        self._middle = len(params.pieces.counts) // 2
        self._embeddings: list[np.ndarray] = []
        self._oversegmentations: list[_Oversegmentation] = []
        most = min(max(*params.pieces.counts, most_motions), len(views[0].kernel))
        subsets = _view_sets(len(views))
        for subset in subsets:
            kernel = sum(views[index].kernel.astype(np.float64) for index in subset) / len(subset)
            _, vectors = leading_eigenpairs(normalise_affinity(kernel), most)
            self._embeddings.append(vectors)
            for count in params.pieces.counts:
                pieces = self._cluster(vectors, min(count, most))
                by_view = [piece_affinity(view.residual, pieces, params.pieces) for view in views]
                affinities = (sum(by_view[index] for index in other) / len(other) for other in subsets)
                self._oversegmentations.append(_Oversegmentation(pieces, tuple(map(link_pieces, affinities))))

    @property
    def pieces(self) -> np.ndarray:
        """Pieces int (N,) of the middle number, from all views together."""
        return self._oversegmentations[self._middle].pieces

    def of(self, num_motions: int) -> list[np.ndarray]:
        """Different labelings int (N,) into at most so many groups."""
        found = [self._cluster(vectors, num_motions) for vectors in self._embeddings]
        for pieces, merged in self._oversegmentations:
            found += [groups[num_motions - 1][pieces] for groups in merged if num_motions <= len(groups)]
        ordered = [in_order(labels) for labels in found]
        return list({labels.tobytes(): labels for labels in ordered}.values())

    def _cluster(self, vectors: np.ndarray, count: int) -> np.ndarray:
        """k-means of the leading eigenvectors, rows of unit length: labels int (N,), each in use."""
        return cluster_many_points(unit_rows(vectors[:, :count]), count, self._num_starts, self._seed)


def in_order(labels: np.ndarray) -> np.ndarray:
    """Labels int64 (N,) renumbered from 0 in the order of their first trajectories."""
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse]


def _view_sets(num_views: int) -> list[tuple[int, ...]]:
    """All views together and, of three or more, all but the first: models stand from the least general to the most, and
    where a clip is deep or turns, an affinity of the image plane says little."""
    everything = tuple(range(num_views))
    return [everything, everything[1:]] if num_views > 2 else [everything]
