"""The geometric cost of a grouping of trajectories: residuals under one fundamental matrix per group."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.geometry.eight_point import SAMPLE_SIZE, epipolar_equations, nearest_rank_two
from moseg.tasks.geometry.sampson import gradient_coefficients, gradient_monomials

_LAST_ROUNDS = 2
"""Rounds with the final threshold."""
_MIN_GRADIENT = 1e-20
"""Squared gradient of the error, in coordinates of unit size, below which a point lies on the epipole."""


class _Pair(NamedTuple):
    """Data of the fits to two frames, of the trajectories visible in both."""

    seen: np.ndarray
    """int (n,)"""
    equations: np.ndarray
    """float64 (n, 9): rows of x1' F x0."""
    products: np.ndarray
    """float64 (n, 81): their outer products."""
    quadratics: np.ndarray
    """float64 (12, n): quadratic monomials of x0, then of x1."""
    thresholds: np.ndarray
    """float64 (n,): tau of each trajectory, in the unit of the coordinates."""


class _Fits(NamedTuple):
    """The groups fitted to one pair: their indices, and their members float64 (k, n) among its trajectories."""

    pair: _Pair
    groups: np.ndarray
    members: np.ndarray


class EpipolarCost:
    """The cost of groups of trajectories, with one fundamental matrix per group and pair of frames.

    The cost of a group is the sum over its observations of ``min(d² / tau², 1)``, d the Sampson distance. The tolerance
    grows with the displacement, ``tau² = threshold² + (relative |u|)²``: points that pass by fast and near are tracked
    less accurately and deviate more from a rigid motion. All groups are fitted together by iteratively reweighted least
    squares: a fit only needs the weighted sum of the equations' outer products, so that a hundred groups cost little
    more than one. It starts from all points of the group, and the scale of the loss is halved in each round down to
    tau, so that outliers are gradually down-weighted. With many outliers PoseLib finds better matrices, at about a
    hundred times the cost.

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
        gap = min(params.gap, points.shape[1] - 1)
        firsts = range(0, points.shape[1] - gap, params.step) if gap > 0 else ()
        pairs = (_prepare(points, visible, first, first + gap, params) for first in firsts)
        self._pairs = [pair for pair in pairs if pair is not None]
        self._num_observations = sum(len(pair.seen) for pair in self._pairs)
        self._known: dict[bytes, float] = {}

    def of_labelings(self, labelings: Sequence[np.ndarray]) -> np.ndarray:
        """Return the mean cost of an observation under each labeling int (N,): float64 (len(labelings),) in 0..1.

        It is 0 if no two frames share eight trajectories.
        """
        groups = [[labels == label for label in np.unique(labels)] for labels in labelings]
        new = {
            group.tobytes(): group for labeling in groups for group in labeling if group.tobytes() not in self._known
        }
        if new:
            self._known.update(zip(new, self._of_groups(np.stack(list(new.values()))), strict=True))
        totals = [sum(self._known[group.tobytes()] for group in labeling) for labeling in groups]
        return np.array(totals) / max(self._num_observations, 1)

    def of_trajectories(self, labels: np.ndarray) -> np.ndarray:
        """Return the cost of each trajectory in each group of a labeling int (N,) with labels 0 .. K - 1.

        The fundamental matrices are those of the groups as they are; summed over the trajectories of each group, the
        costs are about the mean cost of an observation. A group too small for a matrix costs nothing.

        Returns
        -------
        float64 (N, K)
        """
        costs = np.zeros((len(labels), int(labels.max()) + 1))
        groups = labels == np.arange(costs.shape[1])[:, None]
        for fit, (_, matrices) in self._fit_groups(groups):
            squared, _ = _squared_distances(fit.pair, matrices)
            costs[np.ix_(fit.pair.seen, fit.groups)] += np.minimum(squared, 1.0).T
        return costs / max(self._num_observations, 1)

    def _of_groups(self, groups: np.ndarray) -> np.ndarray:
        """Return the cost float64 (K,) of groups bool (K, N)."""
        costs = np.zeros(len(groups))
        for fit, (min_costs, _) in self._fit_groups(groups):
            costs[fit.groups] += min_costs
        return costs

    def _fit_groups(self, groups: np.ndarray) -> Iterator[tuple[_Fits, tuple[np.ndarray, np.ndarray]]]:
        """Yield the fits of groups bool (K, N) to each pair, with their costs and matrices (`_fit_all`)."""
        fits: list[_Fits] = []
        for pair in self._pairs:
            members = groups[:, pair.seen].astype(np.float64)
            # A fundamental matrix fits up to seven points exactly.
            fitted = np.flatnonzero(members.sum(axis=1) >= SAMPLE_SIZE)
            fits.append(_Fits(pair, fitted, members[fitted]))
        if fits:
            yield from zip(fits, _fit_all(fits, self._params.num_fits), strict=True)


def _prepare(points: np.ndarray, visible: np.ndarray, frame0: int, frame1: int, params: EnergyParams) -> _Pair | None:
    """Return the data of the fits to a pair, in coordinates of about unit size; None for too few trajectories."""
    seen = np.flatnonzero(visible[:, frame0] & visible[:, frame1])
    if len(seen) < SAMPLE_SIZE:
        return None
    both = points[seen][:, [frame0, frame1]].astype(np.float64)
    both -= both.mean(axis=(0, 1))
    scale = float(np.sqrt(np.mean(both**2))) or 1.0
    points0, points1 = np.moveaxis(both / scale, 1, 0)
    displacement = np.sum((points1 - points0) ** 2, axis=1)
    thresholds = np.sqrt((params.threshold / scale) ** 2 + params.relative**2 * displacement)
    equations = epipolar_equations(points0, points1)
    products = (equations[:, :, None] * equations[:, None, :]).reshape(len(seen), 81)
    return _Pair(seen, equations, products, gradient_monomials(points0, points1), thresholds)


def _fit_all(fits: list[_Fits], num_iterations: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the smallest cost of each group over the iterations and its last matrix (k, 3, 3), for each pair."""
    weights = [fit.members for fit in fits]
    min_costs = [np.full(len(fit.groups), np.inf) for fit in fits]
    bounds = np.cumsum([0, *(len(fit.groups) for fit in fits)])
    for left in reversed(range(num_iterations)):
        sums = [weight @ fit.pair.products for fit, weight in zip(fits, weights, strict=True)]
        matrices = _solve(np.concatenate(sums).reshape(-1, 9, 9))
        far = 4.0 ** max(left - _LAST_ROUNDS, 0)
        for index, fit in enumerate(fits):
            squared, gradient = _squared_distances(fit.pair, matrices[bounds[index] : bounds[index + 1]])
            costs = (np.minimum(squared, 1.0) * fit.members).sum(axis=1)
            min_costs[index] = np.minimum(min_costs[index], costs)
            # Weight of the Geman-McClure loss on the first-order geometric error.
            weights[index] = fit.members / (gradient * (1.0 + squared / far) ** 2)
    return list(zip(min_costs, np.split(matrices, bounds[1:-1]), strict=True))


def _squared_distances(pair: _Pair, matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return d² / tau² of all trajectories of a pair to matrices (k, 3, 3), and the squared gradients: (k, n) each."""
    error = matrices.reshape(-1, 9) @ pair.equations.T
    gradient = np.maximum(gradient_coefficients(matrices) @ pair.quadratics, _MIN_GRADIENT) * pair.thresholds**2
    return error**2 / gradient, gradient


def _solve(normal: np.ndarray) -> np.ndarray:
    """Solve sums (K, 9, 9) of the equations' outer products for fundamental matrices (K, 3, 3) of unit norm.

    The same sums contain the points' centroids and extents, so that each group has its own Hartley normalisation.
    """
    transform0, transform1 = _hartley_of(normal, [6, 7]), _hartley_of(normal, [2, 5])
    change = (transform1[:, :, None, :, None] * transform0[:, None, :, None, :]).reshape(-1, 9, 9)
    _, vectors = np.linalg.eigh(change @ normal @ np.swapaxes(change, 1, 2))
    F = nearest_rank_two(vectors[:, :, 0].reshape(-1, 3, 3))
    F = np.swapaxes(transform1, 1, 2) @ F @ transform0
    return F / np.linalg.norm(F, axis=(1, 2), keepdims=True)


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
