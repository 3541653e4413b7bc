"""The geometric cost of a grouping of trajectories: residuals under one fundamental matrix per group."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.geometry.eigenvectors import largest_eigenvector, smallest_eigenvector
from moseg.tasks.geometry.eight_point import SAMPLE_SIZE, epipolar_equations
from moseg.tasks.geometry.sampson import gradient_coefficients, gradient_monomials
from moseg.tasks.trajectories.groups import groups_of

_LAST_ROUNDS = 2
"""Rounds with the final threshold."""
_MIN_GRADIENT = 1e-20
"""Squared gradient of the error, in coordinates of unit size, below which a point lies on the epipole."""


_ROWS, _COLUMNS = np.triu_indices(9)
_ENTRY = np.zeros((9, 9), np.int64)
_ENTRY[_ROWS, _COLUMNS] = _ENTRY[_COLUMNS, _ROWS] = np.arange(len(_ROWS))
"""Place of each entry of a symmetric matrix among its 45 entries above and on the diagonal."""
_BLOCK = 2**16
"""Observations times groups that are fitted at once, so that work arrays fit in the processor's cache."""


class _Pairs(NamedTuple):
    """Data of the fits to S pairs of frames, of up to n trajectories visible in both."""

    tracks: np.ndarray
    """int (S, n)"""
    is_seen: np.ndarray
    """bool (S, n): False for the rest of a pair that shows fewer."""
    equations: np.ndarray
    """float64 (S, n, 9): rows of x1' F x0."""
    products: np.ndarray
    """float64 (S, n, 45): their outer products."""
    quadratics: np.ndarray
    """float64 (S, 12, n): quadratic monomials of x0, then of x1."""
    thresholds: np.ndarray
    """float64 (S, n): squared tau of each trajectory, in the unit of the coordinates."""


class _GroupFits(NamedTuple):
    """Fits of one group to S pairs."""

    cost: float
    """Sum over the observations of the group in all pairs that it is fitted to."""
    is_fitted: np.ndarray
    """bool (S,): whether the group has enough trajectories; the matrices of the others are to be ignored."""
    matrices: np.ndarray
    """float64 (S, 3, 3)"""


class EpipolarCost:
    """The cost of groups of trajectories, with one fundamental matrix per group and pair of frames.

    Pairs of neighbouring frames are seen by most trajectories; those farther apart show slow motion, and parallax that
    is lost in noise before.

    The cost of a group is the sum over its observations of ``min(d² / tau², 1)``, d the Sampson distance. The tolerance
    grows with the displacement, ``tau² = threshold² + (relative |u|)²``: points that pass by fast and near are tracked
    less accurately and deviate more from a rigid motion. All groups are fitted together by iteratively reweighted least
    squares: a fit only needs the weighted sum of the equations' outer products, and a hundred groups together take half
    the time of one after another. It starts from all points of the group, and the scale of the loss is halved in each
    round down to tau, so that outliers are gradually down-weighted. With many outliers PoseLib finds better matrices,
    at about a hundred times the cost.

    Parameters
    ----------
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    params : EnergyParams

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, sections 11.2 and 11.4.3; A. Blake and
    A. Zisserman, Visual Reconstruction, 1987 (graduated non-convexity).
    """

    def __init__(self, points: np.ndarray, visible: np.ndarray, params: EnergyParams):
        self._params = params
        pairs = _sampled_pairs(visible, params)
        seen = [np.flatnonzero(visible[:, pair].all(axis=1)) for pair in pairs]
        enough = [index for index, tracks in enumerate(seen) if len(tracks) >= SAMPLE_SIZE]
        self._num_observations = sum(len(seen[index]) for index in enough)
        self._pairs = _prepare(points, [pairs[index] for index in enough], [seen[index] for index in enough], params)
        self._known: dict[bytes, _GroupFits] = {}

    def of_labelings(self, labelings: Sequence[np.ndarray]) -> np.ndarray:
        """Return the mean cost of an observation under each labeling int (N,): float64 (len(labelings),) in 0..1.

        It is 0 if no two frames share eight trajectories.
        """
        groups = [groups_of(labels) for labels in labelings]
        self._fit_groups([group for labeling in groups for group in labeling])
        totals = [sum(self._known[group.tobytes()].cost for group in labeling) for labeling in groups]
        return np.array(totals) / max(self._num_observations, 1)

    def bounds_of_labelings(self, labelings: Sequence[np.ndarray]) -> np.ndarray:
        """Return what `of_labelings` returns, but without the costs of groups that have not been fitted yet."""
        known = [[self._known.get(group.tobytes()) for group in groups_of(labels)] for labels in labelings]
        totals = [sum(fits.cost for fits in labeling if fits) for labeling in known]
        return np.array(totals) / max(self._num_observations, 1)

    def of_trajectories(self, labels: np.ndarray) -> np.ndarray:
        """Return the cost of each trajectory in each group of a labeling int (N,) with labels 0 .. K - 1.

        The fundamental matrices are those of the groups as they are; summed over the trajectories of each group, the
        costs are about the mean cost of an observation. A group too small for a matrix costs nothing.

        Returns
        -------
        float64 (N, K)
        """
        groups = [labels == label for label in range(int(labels.max()) + 1)]
        costs = np.zeros((len(labels), len(groups)))
        self._fit_groups(groups)
        known = [self._known[group.tobytes()] for group in groups]
        for block, pairs in self._blocks(len(groups)):
            squared, _ = _squared_distances(pairs, np.stack([fits.matrices[block] for fits in known], axis=1))
            is_fitted = np.stack([fits.is_fitted[block] for fits in known], axis=1)
            squared = np.where(is_fitted[..., None], np.minimum(squared, 1.0), 0)
            for tracks, is_seen, each in zip(pairs.tracks, pairs.is_seen, squared, strict=True):
                costs[tracks[is_seen]] += each[:, is_seen].T
        return costs / max(self._num_observations, 1)

    def of_labelings_thoroughly(self, labelings: Sequence[np.ndarray], others: Sequence[np.ndarray]) -> np.ndarray:
        """Return what `of_labelings` returns, with fits that also start from the matrices of all these groups.

        Reweighted least squares may end at a matrix that explains only a part of a group, and one trajectory more or
        less then changes the cost by a tenth. The matrix of a part of a group, or of a union of which it is a part,
        often leads to a better one. The groups of `others` only give such matrices.
        """
        groups = {group.tobytes(): group for labels in labelings for group in groups_of(labels)}
        num_groups = len(groups)
        groups |= {group.tobytes(): group for labels in others for group in groups_of(labels)}
        stacked = np.stack(list(groups.values()))
        self._fit_groups(stacked)
        known = [self._known[key] for key in groups]
        totals = np.zeros(num_groups)
        for block, pairs in self._blocks(len(groups)):
            members = np.moveaxis(stacked[:num_groups, pairs.tracks] & pairs.is_seen, 0, 1).astype(np.float64)
            starts = np.stack([fits.matrices[block] for fits in known], axis=1)
            is_fitted = np.stack([fits.is_fitted[block] for fits in known], axis=1)
            costs = _refit(pairs, members, starts, is_fitted)
            totals += np.where(is_fitted[:, :num_groups], costs, 0).sum(axis=0)
        best = {key: min(total, fits.cost) for key, total, fits in zip(groups, totals, known, strict=False)}
        sums = [sum(best[group.tobytes()] for group in groups_of(labels)) for labels in labelings]
        return np.array(sums) / max(self._num_observations, 1)

    def _fit_groups(self, groups: Sequence[np.ndarray]) -> None:
        """Fit those of the groups bool (N,) that have not been fitted yet, and keep their fits."""
        new = {group.tobytes(): group for group in groups if group.tobytes() not in self._known}
        if not new:
            return
        stacked = np.stack(list(new.values()))
        num_pairs = len(self._pairs.tracks) if self._pairs else 0
        costs, is_fitted = np.zeros(len(new)), np.zeros((num_pairs, len(new)), bool)
        matrices = np.zeros((*is_fitted.shape, 3, 3))
        for block, pairs in self._blocks(len(new)):
            members = np.moveaxis(stacked[:, pairs.tracks] & pairs.is_seen, 0, 1)
            # A fundamental matrix fits up to seven points exactly.
            is_fitted[block] = np.count_nonzero(members, axis=2) >= SAMPLE_SIZE
            min_costs, matrices[block] = _fit(pairs, members.astype(np.float64), self._params.num_fits)
            costs += np.where(is_fitted[block], min_costs, 0).sum(axis=0)
        for index, key in enumerate(new):
            self._known[key] = _GroupFits(float(costs[index]), is_fitted[:, index], matrices[:, index])

    def _blocks(self, num_groups: int) -> Iterator[tuple[slice, _Pairs]]:
        """Yield parts of the pairs such that work arrays for so many groups stay small."""
        if self._pairs is None:
            return
        num_pairs, num_tracks = self._pairs.tracks.shape
        size = max(1, _BLOCK // (num_groups * num_tracks))
        for start in range(0, num_pairs, size):
            block = slice(start, start + size)
            yield block, _Pairs(*(array[block] for array in self._pairs))


def _sampled_pairs(visible: np.ndarray, params: EnergyParams) -> list[tuple[int, int]]:
    """Return the pairs of frames of each gap, spaced out by a share of it, and by more in long clips.

    Trajectories that last longest are those of distant points, so that a gap that few span says little of the others.
    """
    num_frames, pairs = visible.shape[1], []
    for gap in sorted({min(gap, num_frames - 1) for gap in params.gaps} - {0}):
        seen = np.count_nonzero(visible[:, :-gap] & visible[:, gap:])
        if pairs and seen < params.min_spanning * np.count_nonzero(visible[:, :-gap]):
            continue
        step = math.ceil(params.spacing * gap)
        mean = seen / step / max(len(visible), 1)
        firsts = range(0, num_frames - gap, step * max(1, math.ceil(mean / params.max_pairs)))
        pairs += [(first, first + gap) for first in firsts]
    return pairs


def _prepare(
    points: np.ndarray, pairs: list[tuple[int, int]], seen: list[np.ndarray], params: EnergyParams
) -> _Pairs | None:
    """Return the data of the fits to pairs, each in coordinates of about unit size; None without a pair."""
    if not pairs:
        return None
    shape = len(pairs), max(map(len, seen))
    data = _Pairs(
        np.zeros(shape, np.int64),
        np.zeros(shape, bool),
        np.zeros((*shape, 9)),
        np.zeros((*shape, len(_ROWS))),
        np.zeros((len(pairs), 12, shape[1])),
        np.ones(shape),
    )
    for index, (pair, tracks) in enumerate(zip(pairs, seen, strict=True)):
        own = slice(len(tracks))
        both = points[tracks[:, None], pair].astype(np.float64)
        both -= both.mean(axis=(0, 1))
        scale = float(np.sqrt(np.mean(both**2))) or 1.0
        points0, points1 = np.moveaxis(both / scale, 1, 0)
        displacement = np.sum((points1 - points0) ** 2, axis=1)
        equations = epipolar_equations(points0, points1)
        data.tracks[index, own], data.is_seen[index, own] = tracks, True
        data.equations[index, own] = equations
        data.products[index, own] = equations[:, _ROWS] * equations[:, _COLUMNS]
        data.quadratics[index, :, own] = gradient_monomials(points0, points1)
        data.thresholds[index, own] = (params.threshold / scale) ** 2 + params.relative**2 * displacement
    return data


def _refit(pairs: _Pairs, members: np.ndarray, starts: np.ndarray, is_fitted: np.ndarray) -> np.ndarray:
    """Fit groups from the best of the matrices (S, M, 3, 3) that are fitted, bool (S, M): smallest costs (S, K)."""
    squared, gradient = _squared_distances(pairs, starts)
    bounded = np.where(is_fitted[..., None], np.minimum(squared, 1.0), 1.0)
    costs = members @ np.swapaxes(bounded, 1, 2)
    best = costs.argmin(axis=2)[..., None]
    squared, gradient = (np.take_along_axis(values, best, axis=1) for values in (squared, gradient))
    min_costs, _ = _fit(pairs, members, _LAST_ROUNDS, members / ((1.0 + squared) ** 2 * gradient))
    return np.minimum(min_costs, costs.min(axis=2))


def _fit(
    pairs: _Pairs, members: np.ndarray, num_iterations: int, start: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Fit groups with members float64 (S, K, n): smallest costs over the iterations (S, K), last (S, K, 3, 3).

    `start` are the weights (S, K, n) of the first iteration instead of the members.
    """
    weights, shape = members if start is None else start, members.shape[:2]
    min_costs = np.full(shape, np.inf)
    for left in reversed(range(num_iterations)):
        matrices = _solve((weights @ pairs.products).reshape(-1, len(_ROWS))[:, _ENTRY])
        matrices = matrices.reshape(*shape, 3, 3)
        squared, gradient = _squared_distances(pairs, matrices)
        min_costs = np.minimum(min_costs, np.einsum("skn,skn->sk", np.minimum(squared, 1.0), members))
        if left:
            # Weight of the Geman-McClure loss on the first-order geometric error.
            squared /= 4.0 ** max(left - _LAST_ROUNDS, 0)
            squared += 1.0
            squared *= squared
            squared *= gradient
            weights = np.divide(members, squared, out=squared)
    return min_costs, matrices


def _squared_distances(pairs: _Pairs, matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return d² / tau² of all trajectories to matrices (S, K, 3, 3), and the squared gradients: (S, K, n) each."""
    gradient = gradient_coefficients(matrices) @ pairs.quadratics
    np.maximum(gradient, _MIN_GRADIENT, out=gradient)
    gradient *= pairs.thresholds[:, None]
    squared = matrices.reshape(*matrices.shape[:2], 9) @ np.swapaxes(pairs.equations, 1, 2)
    squared *= squared
    squared /= gradient
    return squared, gradient


def _solve(normal: np.ndarray) -> np.ndarray:
    """Solve sums (K, 9, 9) of the equations' outer products for fundamental matrices (K, 3, 3) of unit norm.

    The same sums contain the points' centroids and extents, so that each group has its own Hartley normalisation.
    """
    transform0, transform1 = _hartley_of(normal, [6, 7]), _hartley_of(normal, [2, 5])
    change = (transform1[:, :, None, :, None] * transform0[:, None, :, None, :]).reshape(-1, 9, 9)
    F = _nearest_rank_two(smallest_eigenvector(change @ normal @ np.swapaxes(change, 1, 2)).reshape(-1, 3, 3))
    F = np.swapaxes(transform1, 1, 2) @ F @ transform0
    return F / np.sqrt(np.einsum("kij,kij->k", F, F))[:, None, None]


def _nearest_rank_two(F: np.ndarray) -> np.ndarray:
    """Return the matrix of rank 2 nearest to each F (K, 3, 3), as by a singular value decomposition but faster."""
    # The cofactors have the same singular vectors, and the singular value of the smallest becomes the largest.
    rows = (F[:, row] for row in range(3))
    first, second, third = ((row[:, [1, 2, 0]], row[:, [2, 0, 1]]) for row in rows)
    cofactors = np.stack([a[0] * b[1] - a[1] * b[0] for a, b in ((second, third), (third, first), (first, second))], 1)
    least = largest_eigenvector(np.swapaxes(cofactors, 1, 2) @ cofactors)
    return F - (F @ least[:, :, None]) * least[:, None]


def _hartley_of(normal: np.ndarray, xy: list[int]) -> np.ndarray:
    """Return the transforms (K, 3, 3) to centroid 0 and root mean square radius sqrt(2).

    x and y are the equations' terms `xy`, 1 is term 8.
    """
    total = np.maximum(normal[:, 8, 8], np.finfo(np.float64).tiny)
    centroid = normal[:, 8, xy] / total[:, None]
    spread = normal[:, xy, xy].sum(axis=1) / total - (centroid**2).sum(axis=1)
    scale = np.sqrt(2 / np.maximum(spread, np.finfo(np.float64).eps))
    transform = np.zeros((len(normal), 3, 3))
    transform[:, 0, 0] = transform[:, 1, 1] = scale
    transform[:, :2, 2] = -scale[:, None] * centroid
    transform[:, 2, 2] = 1
    return transform
