"""Matched points of two or three frames, the data of point models."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError


class Correspondences(NamedTuple):
    """N points tracked over F frames, or a stack of such sets.

    Attributes
    ----------
    points : float64 (..., N, F, 2)
        xy, px.
    inverse_depth : float64 (..., N), optional
        Relative inverse depth of each point in the first frame.
    principal_point : (float, float), optional
        xy of the optical axis, px, usually the image's centre. Only models with depth read it.
    """

    points: np.ndarray
    inverse_depth: np.ndarray | None = None
    principal_point: tuple[float, float] | None = None

    @property
    def num_points(self) -> int:
        """Number of points, N."""
        return self.points.shape[-3]

    def take(self, index: np.ndarray) -> "Correspondences":
        """Return the points of an index or mask into N, of data without leading dimensions.

        An index of shape (H, S) gives H samples of S points: points (H, S, F, 2).
        """
        depth = None if self.inverse_depth is None else self.inverse_depth[index]
        return self._replace(points=self.points[index], inverse_depth=depth)


def checked(data: Correspondences, num_frames: int, needs_depth: bool) -> Correspondences:
    """Return the data in float64; raise InputError if a model of `num_frames` frames cannot use it."""
    points = np.asarray(data.points, dtype=np.float64)
    if points.ndim < 3 or points.shape[-2:] != (num_frames, 2):
        raise InputError(
            "wrong shape of correspondences", where="points", got=points.shape, expected=f"(..., N, {num_frames}, 2)"
        )
    if not needs_depth:
        return data._replace(points=points)
    if data.inverse_depth is None or data.principal_point is None:
        missing = "inverse_depth" if data.inverse_depth is None else "principal_point"
        raise InputError("a model with depth lacks its data", where=missing, got=None)
    depth = np.asarray(data.inverse_depth, dtype=np.float64)
    if depth.shape != points.shape[:-2]:
        raise InputError("wrong shape of depth", where="inverse_depth", got=depth.shape, expected=points.shape[:-2])
    return data._replace(points=points, inverse_depth=depth)


def checked_for_fit(data: Correspondences, num_frames: int, needs_depth: bool, sample_size: int) -> Correspondences:
    """Return the data as `checked` does; also raise InputError for fewer than `sample_size` points."""
    data = checked(data, num_frames, needs_depth)
    if data.num_points < sample_size:
        raise InputError("too few points", where="points", got=data.num_points, expected=f"{sample_size} or more")
    return data
