"""The coding length of a grouping of trajectories: bits that describe the trajectories of each group together."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import CodingParams
from moseg.tasks.trajectories.projective_depths import MIN_TRACKS, projective_depths
from moseg.tasks.trajectories.track_windows import TrackWindow, track_windows


class _Group(NamedTuple):
    """Bits of a group without its labels, and its trajectories: float64 (windows,) each."""

    bits: np.ndarray
    counts: np.ndarray


class CodingLength:
    """The bits that describe trajectories over many frames, group by group, with a precision of `noise` pixels.

    Two frames constrain a rigid motion weakly: a fundamental matrix leaves the position along the epipolar line free,
    and under a nearly affine camera one matrix may explain two motions. Over many frames the trajectories of a rigid
    motion lie in a subspace of few dimensions, and the trajectories of two motions in one of more. The bits of n
    trajectories, rows of a matrix Y of D coordinates about their mean, are those of a Gaussian of the same covariance,

        (n + min(D, 2n)) / 2 * log2 det(I + Y'Y / (n noise²)) - n log2(n / N),

    where N is the number of trajectories of the window. The last term describes the labels. The coordinates of a group
    that codes itself need at least as many bits as its covariance has parameters; the bound 2n keeps small groups from
    paying for directions that they do not have.

    The subspace has four dimensions for an affine camera. Perspective adds dimensions, so that a deep background would
    be described better in two parts. Each group is therefore coded twice, as it is and with its trajectories multiplied
    by projective depths (`projective_depths`), which restores the four dimensions; the depths are linear in the
    structure, and add four parameters a frame, `D log2 n` bits. The smaller number counts.

    Parameters
    ----------
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    params : CodingParams

    References
    ----------
    Y. Ma, H. Derksen, W. Hong and J. Wright, "Segmentation of multivariate mixed data via lossy data coding and
    compression", PAMI 2007, equations 10 and 11; S. Rao, R. Tron, R. Vidal and Y. Ma, "Motion segmentation in the
    presence of outlying, incomplete, or corrupted trajectories", PAMI 2010.
    """

    def __init__(self, points: np.ndarray, visible: np.ndarray, params: CodingParams):
        self._params = params
        self._windows = track_windows(points, visible, params)
        self._sizes = np.array([len(window.tracks) for window in self._windows], dtype=np.float64)
        self._known: dict[bytes, _Group] = {}
        everything = np.zeros(len(points), int)
        self._unit = self._bits(everything)

    def of_labelings(self, labelings: Sequence[np.ndarray]) -> np.ndarray:
        """Return the bits of each labeling int (N,) as a share of those of one motion: float64 (len(labelings),).

        It is 1 for all labelings if no window shows enough trajectories.
        """
        if self._unit <= 0:
            return np.ones(len(labelings))
        return np.array([self._bits(labels) for labels in labelings]) / self._unit

    def _bits(self, labels: np.ndarray) -> float:
        """Return the bits of a labeling, over all windows."""
        total = 0.0
        for label in np.unique(labels):
            group = self._group(labels == label)
            share = np.divide(group.counts, self._sizes, out=np.ones_like(self._sizes), where=group.counts > 0)
            total += float(np.sum(group.bits - group.counts * np.log2(share)))
        return total

    def _group(self, members: np.ndarray) -> _Group:
        """Return the bits of a group bool (N,)."""
        key = members.tobytes()
        if key not in self._known:
            inside = [members[window.tracks] for window in self._windows]
            bits = [self._of_tracks(window, own) for window, own in zip(self._windows, inside, strict=True)]
            self._known[key] = _Group(np.array(bits), np.array([np.count_nonzero(own) for own in inside], float))
        return self._known[key]

    def _of_tracks(self, window: TrackWindow, own: np.ndarray) -> float:
        """Return the bits of the trajectories bool (n,) of a window."""
        points = window.points[own]
        if not len(points):
            return 0.0
        noise = self._params.noise
        bits = gaussian_bits(points, noise)
        if len(points) >= MIN_TRACKS:
            centred = points - points.mean(axis=(0, 1))
            depths = projective_depths(centred, self._params.num_rounds)
            num_depth_bits = 2 * points.shape[1] * np.log2(len(points))
            bits = min(bits, gaussian_bits(centred * depths[..., None], noise) + num_depth_bits)
        return bits


def gaussian_bits(points: np.ndarray, noise: float) -> float:
    """Return the bits that describe trajectories (n, frame, xy) as samples of one Gaussian, up to `noise`, px."""
    num, dimension = len(points), 2 * points.shape[1]
    rows = points.reshape(num, dimension)
    rows = (rows - rows.mean(axis=0)) / (noise * np.sqrt(num))
    scatter = rows @ rows.T if num < dimension else rows.T @ rows
    _, log_determinant = np.linalg.slogdet(np.eye(len(scatter)) + scatter)
    return (num + min(dimension, 2 * num)) / 2 * float(log_determinant) / np.log(2)
