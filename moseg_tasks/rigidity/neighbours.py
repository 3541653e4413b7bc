"""Neighbours of each track that move like it, and medians over them."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from moseg.schemas.parameters import RigidityParams

_LEAST_WEIGHT = 1e-9  # a track without similar neighbours still has its own median


class Neighbours(NamedTuple):
    """The K most similar of the nearest tracks of each of N tracks, itself among them.

    Attributes
    ----------
    index : intp (N, K)
    weight : float64 (N, K)
        0..1, 1 for itself.
    """

    index: np.ndarray
    weight: np.ndarray

    def median(self, values: np.ndarray) -> np.ndarray:
        """Return the weighted median over each track's neighbours of values (N,): float64 (N,)."""
        near = values[self.index]
        order = np.argsort(near, axis=1)
        cumulated = np.cumsum(np.take_along_axis(self.weight, order, axis=1), axis=1)
        middle = np.count_nonzero(cumulated < cumulated[:, -1:] / 2, axis=1)
        return near[np.arange(len(near)), order[np.arange(len(near)), middle]]

    def mean_with_itself(self, values: np.ndarray) -> np.ndarray:
        """Return the weighted mean over each track and its neighbours, the track counted twice: float64 (N,)."""
        return (values + (values[self.index] * self.weight).sum(axis=1)) / (1 + self.weight.sum(axis=1))


def find_similar(points0: np.ndarray, points1: np.ndarray, params: RigidityParams) -> Neighbours:
    """Find the neighbours of each track, near it in frame 0 and displaced like it.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px; N >= 1.
    params : RigidityParams
    """
    num_tracks = len(points0)
    candidates, num_kept = min(params.neighbour_candidates, num_tracks), min(params.neighbours, num_tracks)
    distance, index = KDTree(points0).query(points0, k=range(1, candidates + 1))
    moved = points1 - points0
    spread = params.neighbour_flow + params.neighbour_flow_share * np.linalg.norm(moved, axis=1)
    apart2 = ((moved[index] - moved[:, None]) ** 2).sum(axis=2) / spread[:, None] ** 2
    misfit = (distance / params.neighbour_distance) ** 2 + apart2
    chosen = np.argpartition(misfit, num_kept - 1, axis=1)[:, :num_kept]
    weight = np.exp(-np.take_along_axis(misfit, chosen, axis=1))
    return Neighbours(np.take_along_axis(index, chosen, axis=1), weight + _LEAST_WEIGHT)
