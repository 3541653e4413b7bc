"""The energy of a grouping: how badly rigid motions explain its groups, and how much affinity it cuts."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.trajectories.epipolar_cost import EpipolarCost


class Grouping(NamedTuple):
    """A labeling int (N,) and what it costs."""

    labels: np.ndarray
    cost: float
    """Mean truncated cost of an observation, as a share of that under a single motion or of `least_unit`."""
    cut: float
    """Normalised cut, 0 .. number of groups."""
    energy: float
    """Cost and cut together, and what each motion costs."""


class Energy:
    """``cost + cut_weight * cut + motion_weight * K`` of groupings of the same trajectories into K motions.

    Neither of the first two terms does alone. A fundamental matrix explains two movers that go the same way, or a mover
    along the camera's path together with the background, nearly as well as one: by cost alone the background is rather
    split. A cut alone splits the background where few hypotheses reach from one side of the image to the other. The
    third makes one motion of what is explained by two hardly better.

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
        self._kernel = kernel
        self._params = params
        # What one motion explains well needs no second, however large a share of the little that is left that takes.
        self._unit = max(float(self._cost.of_labelings([np.zeros(len(points), int)])[0]), params.least_unit)

    def prepare(self, labelings: Sequence[np.ndarray]) -> None:
        """Fit all groups of labelings that will be asked for."""
        self._cost.of_labelings(labelings)

    def least(self, labelings: Sequence[np.ndarray]) -> Grouping:
        """The labeling of least energy, the first of equals."""
        costs = self._cost.of_labelings(labelings) / self._unit
        return min(map(self._grouping, labelings, costs), key=lambda grouping: grouping.energy)

    def cut(self, labels: np.ndarray) -> float:
        """Normalised cut of a labeling."""
        return normalised_cut(self._kernel, labels)

    def _grouping(self, labels: np.ndarray, cost: float) -> Grouping:
        cut, num_motions = self.cut(labels), len(np.unique(labels))
        energy = float(cost) + self._params.cut_weight * cut + self._params.motion_weight * num_motions
        return Grouping(labels, float(cost), cut, energy)


def normalised_cut(kernel: np.ndarray, labels: np.ndarray) -> float:
    """Share of each group's affinity that leads out of it, summed over groups.

    Parameters
    ----------
    kernel : floating (N, N)
        Symmetric and non-negative.
    labels : int (N,)

    Returns
    -------
    float
        0 .. number of groups; a group without any affinity counts as cut off.

    References
    ----------
    J. Shi and J. Malik, "Normalized cuts and image segmentation", PAMI 2000, equation 2.
    """
    members = (labels[:, None] == np.unique(labels)).astype(kernel.dtype)
    degrees = kernel.sum(axis=1) @ members
    inside = np.einsum("nk,nk->k", members, kernel @ members)
    return float(np.sum(1.0 - np.divide(inside, degrees, out=np.zeros_like(inside), where=degrees > 0)))
