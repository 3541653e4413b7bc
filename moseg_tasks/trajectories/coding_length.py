"""The coding length of a grouping of trajectories: bits that describe the trajectories of each group together."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters import CodingParams
from moseg.tasks.trajectories.groups import groups_of
from moseg.tasks.trajectories.projective_depths import MIN_TRACKS, projective_depths
from moseg.tasks.trajectories.track_windows import TrackWindow, track_windows

_DIRECTIONS = 3
"""Dimensions of a rigid motion's trajectories about their mean under an affine camera."""


class CodingLength:
    """The bits that describe trajectories over many frames, group by group, with a precision of `noise` pixels.

    Two frames constrain a rigid motion weakly: a fundamental matrix leaves the position along the epipolar line free,
    and under a nearly affine camera one matrix may explain two motions. Over many frames the trajectories of a rigid
    motion lie in a subspace of few dimensions, and those of two motions in one of more. The bits of n trajectories in a
    window of D / 2 frames are those of samples of a Gaussian,

        (n + E) / 2 * log2 det(I + Y'Y / (n noise²)) - n log2(n / N),   1 / E² = 1 / D² + 1 / (2n)²,

    where the rows of Y are the coordinates about their mean, and N is the number of trajectories of the window. The
    n / 2 log2 det describe the coordinates in the subspace, E / 2 log2 det the subspace, and the last term the labels.
    E is D for large groups and at most 2n, so that small groups do not pay for directions that they do not have. It is
    concave in n, so that the parts of a group together always pay for more than the whole. The coordinates of a few
    frames are read, because more of a smooth motion hardly change the determinant, but the subspace is paid for in all.

    The subspace has four dimensions for an affine camera. Perspective adds dimensions, so that a deep background would
    be described better in two parts. Each group is therefore coded twice, as it is and with its trajectories multiplied
    by projective depths (`projective_depths`), which restores the four dimensions; the depths are linear in the
    structure, which adds four parameters a frame, `D log2 n` bits. The smaller number counts.

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
        self._known: dict[bytes, float] = {}
        everything = np.zeros(len(points), int)
        self._unit = self._bits(everything)

    def of_labelings(self, labelings: Sequence[np.ndarray]) -> np.ndarray:
        """Return the bits of each labeling int (N,) as a share of those of one motion: float64 (len(labelings),).

        It is 1 for all labelings if no window shows enough trajectories.
        """
        if self._unit <= 0:
            return np.ones(len(labelings))
        return np.array([self._bits(labels) for labels in labelings]) / self._unit

    def of_trajectories(self, labels: np.ndarray) -> np.ndarray:
        """Return the bits by which each group of a labeling int (N,), 0 .. K - 1, grows with each trajectory.

        To first order, and as a share of the bits of one motion. An affine camera is assumed: the depths of a
        trajectory in a group of which it is not a member are not known.

        Returns
        -------
        float64 (N, K)
        """
        growth = np.zeros((len(labels), int(labels.max()) + 1))
        for window in self._windows if self._unit > 0 else ():
            rows = window.points.reshape(len(window.tracks), -1)
            own = labels[window.tracks]
            for label in np.unique(own):
                share = np.mean(own == label)
                bits = _growth(rows, own == label, 2 * window.length, self._params.noise)
                growth[window.tracks, label] += (bits - np.log2(share)) / self._unit
        return growth

    def _bits(self, labels: np.ndarray) -> float:
        """Return the bits of a labeling, over all windows."""
        return sum(map(self._of_group, groups_of(labels)))

    def _of_group(self, members: np.ndarray) -> float:
        """Return the bits of a group bool (N,) and of its labels, over all windows."""
        key = members.tobytes()
        if key not in self._known:
            inside = [members[window.tracks] for window in self._windows]
            bits = [self._of_tracks(window, own) for window, own in zip(self._windows, inside, strict=True)]
            counts = np.array([np.count_nonzero(own) for own in inside], float)
            share = np.divide(counts, self._sizes, out=np.ones_like(self._sizes), where=counts > 0)
            self._known[key] = float(np.sum(np.array(bits) - counts * np.log2(share)))
        return self._known[key]

    def _of_tracks(self, window: TrackWindow, own: np.ndarray) -> float:
        """Return the bits of the trajectories bool (n,) of a window."""
        points = window.points[own]
        num, dimension = len(points), 2 * window.length
        if not num:
            return 0.0
        spectrum = _spectrum_bits(points, self._params.noise)
        factor = (num + _directions(num, dimension)) / 2
        bits, depth_bits = factor * float(spectrum.sum()), dimension * float(np.log2(num))
        # Depths can only save what the affine subspace leaves.
        if num >= MIN_TRACKS and factor * float(spectrum[:-_DIRECTIONS].sum()) > depth_bits:
            centred = points - points.mean(axis=(0, 1))
            scaled = centred * projective_depths(centred, self._params.num_rounds)[..., None]
            bits = min(bits, factor * float(_spectrum_bits(scaled, self._params.noise).sum()) + depth_bits)
        return bits


def _directions(num: int, dimension: int) -> float:
    """Return E: the directions of a subspace in `dimension` coordinates that `num` trajectories pay for."""
    return (dimension**-2.0 + (2.0 * num) ** -2.0) ** -0.5


def _spectrum_bits(points: np.ndarray, noise: float) -> np.ndarray:
    """Return log2 of the variances of trajectories (n, frame, xy) plus 1, ascending, in units of `noise`, px."""
    rows = points.reshape(len(points), -1)
    rows = (rows - rows.mean(axis=0)) / (noise * np.sqrt(len(points)))
    scatter = rows @ rows.T if len(rows) < rows.shape[1] else rows.T @ rows
    return np.log2(1 + np.maximum(np.linalg.eigvalsh(scatter), 0))


def _growth(rows: np.ndarray, own: np.ndarray, dimension: int, noise: float) -> np.ndarray:
    """Return the derivative of a group's bits by the weight of each row (n, D), for the group `own` bool (n,)."""
    members = rows[own]
    num, directions = len(members), _directions(len(members), dimension)
    centred = (rows - members.mean(axis=0)) / noise
    scatter = centred[own].T @ centred[own] / num
    inverse = np.linalg.inv(np.eye(len(scatter)) + scatter)
    _, log_determinant = np.linalg.slogdet(np.eye(len(scatter)) + scatter)
    distance = np.einsum("nd,nd->n", centred @ inverse, centred) - np.sum(scatter * inverse)
    # Half the derivative of num + directions.
    slope = (1 + 2 * (directions / (2 * num)) ** 3) / 2
    return (slope * log_determinant + (num + directions) / (2 * num) * distance) / np.log(2)
