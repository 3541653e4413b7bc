"""Noise of a track's displacement."""

import numpy as np


def displacement_noise(points0: np.ndarray, points1: np.ndarray, noise: float, share: float) -> np.ndarray:
    """Return the standard deviation of displacements (N, 2), float64 (N,), px: `noise` px and a `share` of the length.

    The share stands for what grows with the displacement: errors of the focal length, lens distortion, drift.
    """
    return np.hypot(noise, share * np.linalg.norm(points1 - points0, axis=1))
