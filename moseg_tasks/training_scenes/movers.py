"""Displacement of things: with the camera at their depth, and on their own."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.training_scenes.camera import CameraStep, camera_flow
from moseg.tasks.training_scenes.layers import Displacement, sample_canvas
from moseg.tasks.training_scenes.shapes import Part
from moseg.tasks.training_scenes.surfaces import smooth_noise


class OwnMotion(NamedTuple):
    """Motion of a thing in the image against a static thing in its place, for both steps (to frame -1, to frame 1).

    Attributes
    ----------
    shift : float64 (2, 2)
        px.
    turn, growth : float64 (2,)
        Radians; share.
    middle : float64 (2,)
        xy it turns and grows about, from the middle of the frame, px.
    bend : float32 (2, canvas y, canvas x, 2) or None
        Deformation, px.
    foot : tuple of float or None
        Heights y between which the motion dies out downwards, as that of feet on the ground, px.
    """

    shift: np.ndarray
    turn: np.ndarray
    growth: np.ndarray
    middle: np.ndarray
    bend: np.ndarray | None
    foot: tuple[float, float] | None


def draw_own_motion(
    rng: np.random.Generator, middle: np.ndarray, radius: float, carried: np.ndarray, canvas: tuple[int, int]
) -> OwnMotion:
    """Draw the motion of a thing.

    Parameters
    ----------
    rng : numpy.random.Generator
    middle : float64 (2,)
        From the middle of the frame, px.
    radius : float
        px.
    carried : float64 (2,)
        Displacement of a static thing in its place to the next frame, px.
    canvas : tuple of int
        Height and width, px.
    """
    if rng.random() < 0.45:  # followed by the camera: it hardly moves in the image
        mean = -rng.uniform(0.6, 1.1) * carried + rng.normal(0, 0.5, 2)
    else:
        angle, speed = rng.uniform(0, 2 * np.pi), 0.3 * 67 ** rng.random()
        mean = speed * np.array([np.cos(angle), 0.5 * np.sin(angle)])
    shaken = 1 + rng.choice([0.02, 0.15]) * rng.standard_normal((2, 1))
    signs = np.array([[-1.0], [1.0]])
    turns, grows, bends, walks = rng.random(4) < (0.3, 0.3, 0.4, 0.25)
    bend = None
    if bends:
        size = rng.uniform(0.05, 0.35) * max(1.0, float(np.hypot(*mean)))
        field = [smooth_noise(rng, canvas, radius * rng.uniform(0.3, 1.0)) for _ in range(2)]
        bend = np.stack([sign * size * np.stack(field, axis=-1) for sign in (-1, 1)]).astype(np.float32)
    foot = None
    if walks:
        high = middle[1] + radius * rng.uniform(0.2, 0.7)
        foot = high, high + radius * rng.uniform(0.2, 0.6)
    return OwnMotion(
        signs * mean * shaken,
        turns * rng.normal(0, 0.03) * signs[:, 0],
        grows * rng.normal(0, 0.02) * signs[:, 0],
        middle,
        bend,
        foot,
    )


def displacement_of(
    part: Part | None,
    inverse_depth: float,
    own: OwnMotion | None,
    swings: np.ndarray,
    camera: tuple[CameraStep, CameraStep],
    shape: tuple[int, int],
) -> Displacement:
    """Return the displacement of a part of a thing at one depth, which turns by `swings` (2,) about its joint."""
    side = float(max(shape))
    pivot = None if part is None else part.pivot.astype(np.float32)

    def displacement(step: int, points: np.ndarray) -> np.ndarray:
        index = (step + 1) // 2
        depth = np.full(points.shape[:-1], inverse_depth, np.float32)
        carried = camera_flow(camera[index], depth, points, side)
        if own is None:
            return carried
        return carried + own_displacement(own, index, points, shape, pivot, float(swings[index]))

    return displacement


def own_displacement(
    own: OwnMotion, index: int, points: np.ndarray, shape: tuple[int, int], pivot: np.ndarray | None, swing: float
) -> np.ndarray:
    """Return how points of a thing move against a static thing in their place, float32 (..., 2), px."""
    moved = own.shift[index] + _spun(points - own.middle.astype(np.float32), own.turn[index], own.growth[index])
    if pivot is not None and swing:
        moved = moved + _spun(points - pivot, swing, 0.0)
    if own.bend is not None:
        moved = moved + sample_canvas(own.bend[index], points, shape)
    if own.foot is not None:
        high, low = own.foot
        moved = moved * np.clip((low - points[..., 1:]) / (low - high), 0, 1)
    return moved.astype(np.float32)


def _spun(points: np.ndarray, turn: float, growth: float) -> np.ndarray:
    """Return the displacement of points by a small turn and growth about 0."""
    x, y = points[..., 0], points[..., 1]
    return np.stack([growth * x - turn * y, turn * x + growth * y], axis=-1)
