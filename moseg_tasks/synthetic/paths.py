"""Positions, angles and colours as functions of time, declared as data, and rigid poses.

World and camera axes are x right, y down, z forward; lengths are metres, angles degrees, time is counted in frames.
"""

import math
from typing import NamedTuple

import numpy as np
from pydantic import Field

from moseg.schemas.frozen import Frozen

Vector = tuple[float, float, float]


class Sway(Frozen):
    """One sinusoid added to a path: ``amplitude * sin(2 pi (t / period + phase))``."""

    amplitude: Vector
    period: float = Field(gt=0, description="frames of one oscillation")
    phase: float = Field(0.0, description="share of an oscillation that is complete at frame 0")


class Path(Frozen):
    """A 3-vector as a function of time: ``start + velocity * t`` plus sinusoids."""

    start: Vector = (0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    sways: tuple[Sway, ...] = ()

    @property
    def is_constant(self) -> bool:
        """Whether the vector is the same at every time."""
        return not any(self.velocity) and not any(any(sway.amplitude) for sway in self.sways)

    def at(self, t: float) -> Vector:
        """Return the vector at time ``t``, frames."""
        swings = [math.sin(2.0 * math.pi * (t / sway.period + sway.phase)) for sway in self.sways]
        return tuple(
            self.start[axis]
            + self.velocity[axis] * t
            + sum(sway.amplitude[axis] * swing for sway, swing in zip(self.sways, swings, strict=True))
            for axis in range(3)
        )


STILL = Path()


class Pose(NamedTuple):
    """Rigid motion ``X = rotation x + translation``; float64 (3, 3) and (3,)."""

    rotation: np.ndarray
    translation: np.ndarray


def pose_of(position: Vector, angles_deg: Vector) -> Pose:
    """Return the pose at ``position`` turned by (pitch, yaw, roll) degrees, about x, y and z in the order z, x, y."""
    pitch, yaw, roll = (math.radians(angle) for angle in angles_deg)
    cx, sx, cy, sy, cz, sz = (f(angle) for angle in (pitch, yaw, roll) for f in (math.cos, math.sin))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
    return Pose(_product(about_y, _product(about_x, about_z)), np.array(position, np.float64))


def compose(outer: Pose, inner: Pose) -> Pose:
    """Return the motion that applies ``inner`` first and ``outer`` second."""
    moved = _product(outer.rotation, inner.translation[:, None])[:, 0]
    return Pose(_product(outer.rotation, inner.rotation), moved + outer.translation)


def inverse(pose: Pose) -> Pose:
    """Return the inverse of ``pose``."""
    back = pose.rotation.T
    return Pose(back, -_product(back, pose.translation[:, None])[:, 0])


def _product(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    # Not ``@``: BLAS may fuse or reorder the three products differently on each processor.
    return left[:, :1] * right[:1] + left[:, 1:2] * right[1:2] + left[:, 2:] * right[2:]
