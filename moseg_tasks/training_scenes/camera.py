"""Image motion of a camera that turns, moves and zooms in front of static surfaces."""

from typing import NamedTuple

import numpy as np

_PACES = {"gentle": (1.5, 1.2, 0.006), "strong": (9.0, 5.0, 0.025), "violent": (20.0, 10.0, 0.05)}
"""Deviations of turn and shift, px a frame, and of the growth by motion along the view, share a frame."""


class CameraStep(NamedTuple):
    """Motion of a camera over one frame, in units of the image.

    Attributes
    ----------
    turn : float64 (2,)
        Shift of far points by yaw and pitch, px.
    roll : float
        Radians.
    shift : float64 (2,)
        Shift of points of inverse depth 1 by motion across the view, px.
    ahead : float
        Growth of the image at inverse depth 1 by motion along the view, share per frame.
    zoom : float
        Growth of the image at any depth, share per frame.
    """

    turn: np.ndarray
    roll: float
    shift: np.ndarray
    ahead: float
    zoom: float


def draw_camera(rng: np.random.Generator) -> tuple[CameraStep, CameraStep]:
    """Draw the steps to the frame before and to the frame after: still, or of a random pace, with a shake on top."""
    pace = rng.choice(["still", *_PACES], p=[0.1, 0.45, 0.33, 0.12])
    if pace == "still":
        mean = CameraStep(np.zeros(2), 0.0, np.zeros(2), 0.0, 0.0)
        return mean, mean
    turn, shift, ahead = _PACES[pace]
    moves_across, moves_ahead, zooms = rng.random(3) < (0.7, 0.5, 0.15)
    mean = CameraStep(
        rng.normal(0, turn, 2) * (1, 0.4),
        rng.normal(0, 0.003),
        moves_across * rng.normal(0, shift, 2) * (1, 0.4),
        moves_ahead * rng.normal(0, ahead),
        zooms * rng.normal(0, 0.01),
    )
    shake = rng.choice([0.02, 0.1, 0.4])
    return _shaken(rng, mean, shake, -1.0), _shaken(rng, mean, shake, 1.0)


def camera_flow(step: CameraStep, inverse_depth: np.ndarray, points: np.ndarray, side: float) -> np.ndarray:
    """Return the displacement of static points, float32 (..., 2), px.

    Parameters
    ----------
    step : CameraStep
    inverse_depth : float32 (...)
        1 is near, 0 infinitely far.
    points : float32 (..., 2)
        xy from the middle of the frame, px.
    side : float
        Longer side of the frame, px, taken for the focal length.

    References
    ----------
    Longuet-Higgins, Prazdny, "The interpretation of a moving retinal image", 1980: the quadratic terms of rotation.
    """
    x, y = points[..., 0], points[..., 1]
    turn = step.turn / side**2
    growth = step.zoom + step.ahead * inverse_depth
    bend = turn[0] * x + turn[1] * y
    u = step.turn[0] + step.shift[0] * inverse_depth + growth * x - step.roll * y + bend * x
    v = step.turn[1] + step.shift[1] * inverse_depth + growth * y + step.roll * x + bend * y
    return np.stack([u, v], axis=-1).astype(np.float32)


def _shaken(rng: np.random.Generator, mean: CameraStep, shake: float, sign: float) -> CameraStep:
    """Return `sign` times a motion that differs a little from the mean one."""
    return CameraStep(
        sign * (mean.turn * (1 + shake * rng.normal()) + shake * rng.normal(0, 1.5, 2)),
        sign * mean.roll + shake * rng.normal(0, 0.002),
        sign * mean.shift * (1 + shake * rng.normal()),
        sign * mean.ahead * (1 + shake * rng.normal()),
        sign * mean.zoom * (1 + shake * rng.normal()),
    )
