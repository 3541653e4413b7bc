"""Inverse depth of the static surfaces behind everything: ground, walls, relief."""

import cv2
import numpy as np


def draw_surfaces(rng: np.random.Generator, points: np.ndarray, side: float) -> np.ndarray:
    """Draw the inverse depth of a backdrop: a plane, ground below a horizon or a wall, each with or without relief.

    Parameters
    ----------
    rng : numpy.random.Generator
    points : float32 (y, x, 2)
        xy from the middle of the frame, px.
    side : float
        Longer side of the frame, px.

    Returns
    -------
    inverse_depth : float32 (y, x)
        0 far .. 1 near.
    """
    x, y = points[..., 0] / side, points[..., 1] / side
    far = rng.uniform(0, 0.4)
    depth = np.full(x.shape, far, np.float32)
    kind = rng.choice(["plane", "ground", "wall", "slope"], p=[0.2, 0.45, 0.2, 0.15])
    if kind == "ground":
        horizon = rng.uniform(-0.25, 0.2)
        depth = np.maximum(depth, far + rng.uniform(0.5, 2.5) * (y - horizon - rng.normal(0, 0.05) * x))
    elif kind == "wall":
        slope = rng.normal(0, 0.8)
        depth = depth + slope * x + abs(slope) * 0.5
        if rng.random() < 0.5:
            depth = np.minimum(depth, far + rng.uniform(0.1, 0.5))
    elif kind == "slope":
        depth = depth + rng.normal(0, 0.4) * x + rng.uniform(0, 0.8) * (y + 0.3)
    if rng.random() < 0.5:
        relief = smooth_noise(rng, x.shape, side * 2 ** rng.uniform(-5, -1.5))
        depth = depth + rng.uniform(0.02, 0.2) * relief
    return np.clip(depth, 0, 1.2).astype(np.float32)


def smooth_noise(rng: np.random.Generator, shape: tuple[int, int], scale: float) -> np.ndarray:
    """Return noise float32 (y, x) of unit deviation, smooth over about `scale` px."""
    height, width = (max(3, round(length / scale) + 3) for length in shape)
    coarse = rng.standard_normal((height, width)).astype(np.float32)
    return cv2.resize(coarse, shape[::-1], interpolation=cv2.INTER_CUBIC)
