"""Displacements of the tracks of a frame pair, split by the camera's motion, and inverse depth from parallax."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.geometry.epipolar_split import split_along_epipolar

_FLOOR = 1e-9  # avoids division by zero
_SIDEWAYS = 1e-3
"""Share of the travel along the optical axis up to which the epipole is at infinity."""
_NEAREST = 1e-3
"""Smallest depth in frame 1 over depth in frame 0 for which a parallax is computed: a point that the camera passes."""


class Parallax(NamedTuple):
    """Displacements of N tracks from where the camera's rotation alone would bring them; float64 (N,) or (N, 2).

    Attributes
    ----------
    along : px; the parallax towards growing inverse depth, negative behind infinity.
    across : px; 0 for static points of any depth.
    inverse_depth : relative to the length of the camera's translation.
    rotated : xy, px; position of a point at infinity.
    towards : xy, unit vector of growing inverse depth.
    reach : px; derivative of the parallax by inverse depth at infinity.
    approach : decrease of a point's depth at inverse depth 1, with its sign changed.
    """

    along: np.ndarray
    across: np.ndarray
    inverse_depth: np.ndarray
    rotated: np.ndarray
    towards: np.ndarray
    reach: np.ndarray
    approach: np.ndarray

    def at(self, inverse_depth: np.ndarray, rows: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Return the parallax that the tracks `rows` would have at inverse depths (N,), px."""
        receding = np.maximum(1 + inverse_depth * self.approach[rows], _NEAREST)
        return self.reach[rows] * inverse_depth / receding


def split_displacements(
    points0: np.ndarray, points1: np.ndarray, motion: CameraMotion, shape: tuple[int, int]
) -> Parallax:
    """Split the displacements from `points0` to `points1`, float64 (N, 2), px, by the camera's motion."""
    calibration = _calibration(motion, shape)
    infinite = calibration @ motion.rotation @ np.linalg.inv(calibration)
    epipole = calibration @ motion.translation
    parts = split_along_epipolar(*points0.T, *points1.T, infinite, epipole)
    approach = epipole[2] * parts.scale
    # Exact: from H x, a point at inverse depth d moves by reach * d / (1 + d * approach).
    rest = parts.reach - parts.along * approach
    return Parallax(
        along=parts.along,
        across=parts.across,
        inverse_depth=parts.along / np.where(np.abs(rest) < _FLOOR, _FLOOR, rest),
        rotated=np.column_stack([parts.rotated_x, parts.rotated_y]),
        towards=np.column_stack([parts.towards_x, parts.towards_y]),
        reach=parts.reach,
        approach=approach,
    )


def find_epipole(motion: CameraMotion, shape: tuple[int, int]) -> np.ndarray | None:
    """Return the epipole in frame 0, where frame 1's camera is seen: float64 (2,) xy, px; None if near infinity."""
    epipole = _calibration(motion, shape) @ (motion.rotation.T @ motion.translation)
    return epipole[:2] / epipole[2] if abs(epipole[2]) > _SIDEWAYS else None


def _calibration(motion: CameraMotion, shape: tuple[int, int]) -> np.ndarray:
    height, width = shape
    return np.array([[motion.focal, 0, (width - 1) / 2], [0, motion.focal, (height - 1) / 2], [0, 0, 1]])
