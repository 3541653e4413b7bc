"""Candidate groupings of trajectories, for any number of motions."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.tasks.clustering.kmeans import cluster_many_points
from moseg.tasks.clustering.spectral import leading_eigenpairs, normalise_affinity, unit_rows
from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals
from moseg.tasks.trajectories.pieces import link_pieces, piece_affinity


class View(NamedTuple):
    """Kernel and residuals of one model for N trajectories and one draw of hypotheses."""

    kernel: np.ndarray
    """float32 (N, N): sparsified ordered residual kernel."""
    residual: HypothesisResiduals | None
    """Only read by the energy method."""


class _Oversegmentation(NamedTuple):
    """Pieces int (N,), and their groups by each affinity: int (P, P), [number of groups - 1, piece]."""

    pieces: np.ndarray
    groups: tuple[np.ndarray, ...]


class Candidates:
    """Groupings from one draw of hypotheses, by spectral clustering and by merging of over-segmentations.

    Spectral clustering into the number of motions often cuts the background, the largest group, before it separates a
    small mover. Clustering into more clusters than motions has errors of a percent or two: each piece lies on one
    moving surface. The pieces are then merged by the hypotheses that their median residuals prefer, which are far more
    reliable than those of single trajectories. Several sets of views and numbers of pieces are used because each
    sometimes fails; the energy selects among the groupings.

    Parameters
    ----------
    views : sequence of View
        One for each model, from the least general to the most.
    max_motions : int
        Largest number of motions that `of` is called with, at most N.
    params : TrajectoryClusteringParams
    seed : int
        Seed of the starts of k-means.
    """

    def __init__(self, views: Sequence[View], max_motions: int, params: TrajectoryClusteringParams, seed: int):
        self._num_starts = params.num_starts
        self._seed = seed
        self._num_counts = len(params.pieces.counts)
        self._merged = params.pieces.merged
        self._embeddings: list[np.ndarray] = []
        self._oversegmentations: list[_Oversegmentation] = []
        max_clusters = min(max(*params.pieces.counts, max_motions), len(views[0].kernel))
        subsets = _view_sets(len(views))
        for subset in subsets:
            kernel = sum(views[index].kernel.astype(np.float64) for index in subset) / len(subset)
            _, vectors = leading_eigenpairs(normalise_affinity(kernel), max_clusters)
            self._embeddings.append(vectors)
            for count in params.pieces.counts:
                pieces = self._cluster(vectors, min(count, max_clusters))
                by_view = [piece_affinity(view.residual, pieces, params.pieces) for view in views]
                affinities = (sum(by_view[index] for index in other) / len(other) for other in subsets)
                self._oversegmentations.append(_Oversegmentation(pieces, tuple(map(link_pieces, affinities))))

    @property
    def merged_pieces(self) -> np.ndarray:
        """Return the pieces int (N,) that are merged by energy."""
        if self._merged == "middle":
            return self._oversegmentations[self._num_counts // 2].pieces
        return self._oversegmentations[-1].pieces

    @property
    def finest_pieces(self) -> list[np.ndarray]:
        """Return the pieces int (N,) of the largest number, of each set of views."""
        return [each.pieces for each in self._oversegmentations[self._num_counts - 1 :: self._num_counts]]

    def of(self, num_motions: int) -> list[np.ndarray]:
        """Return the different labelings int (N,) into at most `num_motions` groups."""
        found = [self._cluster(vectors, num_motions) for vectors in self._embeddings]
        for pieces, merged in self._oversegmentations:
            found += [groups[num_motions - 1][pieces] for groups in merged if num_motions <= len(groups)]
        ordered = [in_order(labels) for labels in found]
        return list({labels.tobytes(): labels for labels in ordered}.values())

    def _cluster(self, vectors: np.ndarray, count: int) -> np.ndarray:
        """Cluster the leading eigenvectors, rows of unit length, by k-means: labels int (N,), each in use."""
        return cluster_many_points(unit_rows(vectors[:, :count]), count, self._num_starts, self._seed)


def in_order(labels: np.ndarray) -> np.ndarray:
    """Renumber labels (N,) from 0 in the order of their first trajectories: int64."""
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse]


def _view_sets(num_views: int) -> list[tuple[int, ...]]:
    """Return all views together and, of three or more, all but the first.

    Models are ordered from the least general to the most, and in clips of large depth or rotation an affinity of the
    image plane is not informative.
    """
    everything = tuple(range(num_views))
    return [everything, everything[1:]] if num_views > 2 else [everything]
