"""Distances of trajectories to the hypotheses of a point model, as 16-bit codes of the same order."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.point_models import Correspondences, PointModel
from moseg.tasks.trajectories.trajectory_hypotheses import Hypotheses

NOT_SEEN = np.iinfo(np.uint16).max
"""Code of a trajectory that is not visible in a set of frames, larger than that of any distance."""

_LEAST, _MOST = np.float32(2.0**-30), np.float32(2.0**31)
"""Squared distances outside are set to the bounds, 3e-5 and 5e4 px."""
_DROPPED_BITS = 13
"""Of the mantissa's 23 bits, ten are left: codes resolve relative differences of a thousandth in squared distance."""
_FIRST_CODE = int(_LEAST.view(np.uint32)) >> _DROPPED_BITS
_CACHED_BYTES = 2**26
"""Codes of all trajectories up to this size are computed once; of more, only those that are asked for."""


class SetCodes(NamedTuple):
    """Codes of one set of frames."""

    seen: np.ndarray
    """int (n,): the trajectories visible in all frames of the set."""
    codes: np.ndarray
    """uint16 (n, H)"""


class HypothesisResiduals:
    """Distances of N trajectories to H hypotheses of each of S sets of frames.

    Only their order is used, within a set and by medians. Codes of 16 bits hold it, and are selected from and sorted
    several times faster than floating-point numbers. They are not stored, because they take more time to write and to
    read than to compute.

    Parameters
    ----------
    hypotheses : Hypotheses
    points : float64 (N, frame, xy)
        px.
    visible : bool (N, frame)
    model : PointModel
    codes : uint16 (S, N, H), optional
        `all_codes` of these trajectories, if they are known already.
    """

    def __init__(
        self,
        hypotheses: Hypotheses,
        points: np.ndarray,
        visible: np.ndarray,
        model: PointModel,
        codes: np.ndarray | None = None,
    ):
        self._hypotheses = hypotheses
        self._points = points
        self._model = model
        self._all: list[np.ndarray] = [] if codes is None else [codes]
        self._columns = slice(0, hypotheses.parameters.shape[1])
        self.is_seen = visible[:, hypotheses.frames].all(axis=2).T
        """bool (S, N): whether a trajectory is visible in all frames of a set."""

    @property
    def num_hypotheses(self) -> int:
        """H."""
        return self._columns.stop - self._columns.start

    def draws(self, num_draws: int) -> list["HypothesisResiduals"]:
        """Return the residuals of each draw, of which the hypotheses are consecutive; they share what they compute."""
        size = self.num_hypotheses // num_draws
        parts = [object.__new__(HypothesisResiduals) for _ in range(num_draws)]
        for index, part in enumerate(parts):
            start = self._columns.start + index * size
            part.__dict__ |= self.__dict__ | {"_columns": slice(start, start + size)}
        return parts

    def of_set(self, index: int) -> SetCodes:
        """Return the codes of one set."""
        seen = np.flatnonzero(self.is_seen[index])
        if self._all:
            codes = self._all[0][index, :, self._columns]
            return SetCodes(seen, codes if len(seen) == len(codes) else codes[seen])
        # Selection along the last axis takes longer in another memory order.
        return SetCodes(seen, np.ascontiguousarray(self._compute(index, seen, self._columns)))

    def all_codes(self) -> np.ndarray | None:
        """Return the codes uint16 (S, N, H) of all trajectories, which are computed once; None if they are too large.

        The code of a trajectory in a set that does not show it is `NOT_SEEN`.
        """
        num_sets, num_tracks = self.is_seen.shape
        num_all = self._hypotheses.parameters.shape[1]
        if not self._all and 2 * num_sets * num_tracks * num_all <= _CACHED_BYTES:
            self._all.append(self._of_tracks(np.arange(num_tracks), slice(0, num_all)))
        return self._all[0][..., self._columns] if self._all else None

    def of_tracks(self, tracks: np.ndarray) -> np.ndarray:
        """Return the codes uint16 (S, T, H) of trajectories int (T,), `NOT_SEEN` in sets that do not show them."""
        codes = self.all_codes()
        return self._of_tracks(tracks, self._columns) if codes is None else codes[:, tracks]

    def nearest_distances(self, window: float) -> np.ndarray:
        """Return how far each trajectory is from a share `window` of the hypotheses nearest to it.

        Returns
        -------
        float32 (N,)
            px, the median over the sets that show the trajectory; NaN without such a set.
        """
        count = min(max(1, round(window * self.num_hypotheses)), self.num_hypotheses)
        codes = np.full(self.is_seen.shape, NOT_SEEN, np.uint16)
        for index, nearest in enumerate(codes):
            seen, found = self.of_set(index)
            nearest[seen] = np.partition(found, count - 1, axis=1)[:, count - 1]
        codes.sort(axis=0)
        num_seen = self.is_seen.sum(axis=0)
        medians = codes[np.maximum(num_seen - 1, 0) // 2, np.arange(codes.shape[1])]
        squared = ((medians.astype(np.uint32) + _FIRST_CODE) << _DROPPED_BITS).view(np.float32)
        return np.where(num_seen > 0, np.sqrt(squared), np.float32(np.nan))

    def _of_tracks(self, tracks: np.ndarray, columns: slice) -> np.ndarray:
        codes = np.full((len(self.is_seen), len(tracks), columns.stop - columns.start), NOT_SEEN, np.uint16)
        for index, (found, is_seen) in enumerate(zip(codes, self.is_seen[:, tracks], strict=True)):
            # Assignment to a slice takes half the time of that to a mask.
            own = slice(None) if is_seen.all() else is_seen
            found[own] = self._compute(index, tracks[own], columns)
        return codes

    def _compute(self, index: int, tracks: np.ndarray, columns: slice) -> np.ndarray:
        """Return the codes uint16 (T, H) of trajectories int (T,) in one set that shows them, transposed in memory."""
        data = Correspondences(self._points[tracks[:, None], self._hypotheses.frames[index]])
        # Distances that overflow single precision count as the largest.
        with np.errstate(over="ignore", invalid="ignore"):
            squared = self._model.residual(self._hypotheses.parameters[index, columns], data, np.float32)
        return distance_codes(squared).T


def distance_codes(squared: np.ndarray) -> np.ndarray:
    """Return uint16 codes of squared distances float32, px², in the same order: their exponents and leading bits."""
    bounded = np.fmin(squared, _MOST)
    np.maximum(bounded, _LEAST, out=bounded)
    bits = bounded.view(np.uint32)
    bits >>= _DROPPED_BITS
    bits -= _FIRST_CODE
    return bits.astype(np.uint16)


def preferences(codes: np.ndarray, count: int) -> np.ndarray:
    """Return whether a hypothesis is among the `count` nearest, bool (..., H), or as near as the last of them."""
    count = min(count, codes.shape[-1])
    return codes <= np.partition(codes, count - 1, axis=-1)[..., count - 1 : count]
