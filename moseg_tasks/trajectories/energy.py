"""The energy of a grouping: residuals and coding length of its groups, and the affinity that it cuts."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.trajectories.coding_length import CodingLength
from moseg.tasks.trajectories.epipolar_cost import EpipolarCost
from moseg.tasks.trajectories.groups import labels_in_use
from moseg.tasks.trajectories.joint_searches import Needed, Search, run_together


class Grouping(NamedTuple):
    """A labeling int (N,), its costs and its energy."""

    labels: np.ndarray
    cost: float
    """Mean truncated cost of an observation, as a share of that under a single motion or of `least_unit`."""
    cut: float
    """Normalised cut, 0 .. number of groups."""
    code: float
    """Coding length over many frames, as a share of that of a single motion."""
    energy: float
    """Weighted sum of cost, cut, code and number of motions."""


class Energy:
    """The energy ``cost + cut_weight * cut + coding_weight * code`` of groupings, and a penalty on many motions.

    None of the first three terms is sufficient. One fundamental matrix explains two movers of the same direction, or a
    mover along the camera's path and the background, nearly as well as a single one: the cost alone would rather split
    the background. The cut alone splits the background where few hypotheses span the image. Under a nearly affine
    camera, one motion may explain any two frames; the code compares many frames, but only of the trajectories that span
    them. The penalty on each motion beyond `free_motions` merges motions if one more explains the data only slightly
    better. The three terms are means over N trajectories, of which some split of one motion lowers each by chance, by
    the more the fewer they are: `chance_weight / sqrt(N)` is added to `motion_weight`.

    Parameters
    ----------
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    kernel : floating (N, N)
        Affinity between the trajectories.
    params : EnergyParams
    """

    def __init__(self, points: np.ndarray, visible: np.ndarray, kernel: np.ndarray, params: EnergyParams):
        self._cost = EpipolarCost(points, visible, params)
        self._code = CodingLength(points, visible, params.coding) if params.coding_weight else None
        self._kernel = kernel
        self._params = params
        self._price = motion_price(params, len(points))
        self._cuts: dict[bytes, float] = {}
        # Bounded below: if one motion explains the data well, a relative gain by a second one is not significant.
        self._unit = max(float(self._cost.of_labelings([np.zeros(len(points), int)])[0]), params.least_unit)

    def prepare(self, needed: Needed) -> None:
        """Code and fit all groups of labelings whose coding length or cost is needed later."""
        self._codes(needed.codes)
        self._cost.of_labelings(needed.costs)

    def minimum(self, labelings: Sequence[np.ndarray]) -> Grouping:
        """Return the labeling of minimal energy, the first of equals."""
        # There is always one below infinity.
        return run_together([self.search_below(np.inf, labelings)], self.prepare)[0]

    def search_below(self, limit: float, labelings: Sequence[np.ndarray]) -> Search[Grouping | None]:
        """Search for the labeling of minimal energy, the first of equals; None if no energy is below the limit.

        Fits take most of the time. Cut, code and what is known of the cost bound the energy from below, so that a
        labeling whose bound is too high is not fitted.
        """
        yield Needed(codes=labelings)
        codes = self._codes(labelings)
        bounds = [*map(self._grouping, labelings, self._cost.bounds_of_labelings(labelings) / self._unit, codes)]
        best, place = None, len(labelings)
        for index in sorted(range(len(labelings)), key=lambda index: bounds[index].energy):
            if bounds[index].energy >= limit or (best and bounds[index].energy > best.energy):
                break
            yield Needed(costs=[labelings[index]])
            cost = float(self._cost.of_labelings([labelings[index]])[0]) / self._unit
            found = self._with_cost(bounds[index], cost)
            if found.energy < limit and (best is None or (found.energy, index) < (best.energy, place)):
                best, place = found, index
        return best

    def rank(self, labelings: Sequence[np.ndarray]) -> list[Grouping]:
        """Return the groupings of labelings in the order of their energy."""
        costs = self._cost.of_labelings(labelings) / self._unit
        groupings = map(self._grouping, labelings, costs, self._codes(labelings))
        return sorted(groupings, key=lambda grouping: grouping.energy)

    def thorough(self, groupings: Sequence[Grouping], others: Sequence[np.ndarray]) -> list[Grouping]:
        """Return groupings with the cost of better fits, which start from the groups of all and of other labelings.

        Their energies can be compared with each other only.
        """
        labelings = [np.zeros(len(self._kernel), int), *(grouping.labels for grouping in groupings)]
        costs = self._cost.of_labelings_thoroughly(labelings, others)
        unit = max(float(costs[0]), self._params.least_unit)
        return [self._with_cost(grouping, cost / unit) for grouping, cost in zip(groupings, costs[1:], strict=True)]

    def most_promising(self, labelings: Sequence[np.ndarray], count: int) -> list[np.ndarray]:
        """Return the labelings of lowest cost and cut; many are compared in the time of one coding length."""
        costs = self._cost.of_labelings(labelings) / self._unit
        cuts = np.array([normalised_cut(self._kernel, labels) for labels in labelings])
        order = np.argsort(costs + self._params.cut_weight * cuts, kind="stable")[:count]
        return [labelings[index] for index in order]

    def group_affinities(self, labels: np.ndarray) -> np.ndarray:
        """Return the sums of the affinities between the groups of a labeling, float64 (K, K)."""
        return group_affinities(self._kernel, labels)

    def gradient(self, labels: np.ndarray) -> np.ndarray:
        """Return the energy of each trajectory in each group of a labeling int (N,), 0 .. K - 1, to first order.

        The difference of two groups is about the change of the energy if a trajectory alone moves from one to the
        other: float64 (N, K).
        """
        params = self._params
        slope = self._cost.of_trajectories(labels) / self._unit
        slope += params.cut_weight * normalised_cut_gradient(self._kernel, labels)
        if self._code:
            slope += params.coding_weight * self._code.of_trajectories(labels)
        return slope

    def _codes(self, labelings: Sequence[np.ndarray]) -> np.ndarray:
        return self._code.of_labelings(labelings) if self._code else np.zeros(len(labelings))

    def _grouping(self, labels: np.ndarray, cost: float, code: float) -> Grouping:
        key = labels.tobytes()
        if key not in self._cuts:
            self._cuts[key] = normalised_cut(self._kernel, labels)
        return self._with_cost(Grouping(labels, 0.0, self._cuts[key], float(code), 0.0), cost)

    def _with_cost(self, grouping: Grouping, cost: float) -> Grouping:
        """Return the grouping with another cost and the energy that follows."""
        params, num_motions = self._params, len(labels_in_use(grouping.labels))
        energy = float(cost) + params.cut_weight * grouping.cut + params.coding_weight * grouping.code
        energy += self._price * max(num_motions - params.free_motions, 0)
        return grouping._replace(cost=float(cost), energy=energy)


def motion_price(params: EnergyParams, num_tracks: int) -> float:
    """Return the penalty on each motion beyond `params.free_motions`."""
    return params.motion_weight + params.chance_weight / max(num_tracks, 1) ** 0.5


def normalised_cut(kernel: np.ndarray, labels: np.ndarray) -> float:
    """Return the share of each group's affinity to other groups, summed over groups.

    Parameters
    ----------
    kernel : floating (N, N)
        Symmetric and non-negative.
    labels : int (N,)

    Returns
    -------
    float
        0 .. number of groups; a group without any affinity counts 1.

    References
    ----------
    J. Shi and J. Malik, "Normalized cuts and image segmentation", PAMI 2000, equation 2.
    """
    affinities = group_affinities(kernel, labels)
    inside, degrees = np.diag(affinities), affinities.sum(axis=1)
    return float(np.sum(1.0 - np.divide(inside, degrees, out=np.zeros_like(inside), where=degrees > 0)))


def group_affinities(kernel: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Return the sums of a kernel's entries between groups, float64 (K, K) in the order of the labels."""
    members = (labels[:, None] == labels_in_use(labels)).astype(kernel.dtype)
    return (members.T @ (kernel @ members)).astype(np.float64)


def normalised_cut_gradient(kernel: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Return the derivatives of `normalised_cut` by the membership of each row in each group: float64 (N, K).

    `labels` are 0 .. K - 1, each in use. A row counts as moving alone.
    """
    members = (labels[:, None] == np.arange(int(labels.max()) + 1)).astype(kernel.dtype)
    shared, degree = kernel @ members, kernel.sum(axis=1)
    inside, total = np.einsum("nk,nk->k", members, shared), degree @ members
    slope = inside * degree[:, None] - 2 * shared * total
    return np.divide(slope, total**2, out=np.zeros(slope.shape), where=total > 0).astype(np.float64)
