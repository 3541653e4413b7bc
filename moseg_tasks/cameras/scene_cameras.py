"""Cameras of several views of a scene, decoded from what a network says of each."""

from typing import NamedTuple

import numpy as np

_SMALLEST_TANGENT = 1e-6
"""Of half a field of view, as in the authors' code."""


class SceneCameras(NamedTuple):
    """Cameras of S views, with the principal point in the middle.

    Attributes
    ----------
    rotation : float64 (S, 3, 3)
        From the axes of the camera (x right, y down, z ahead) to those of the scene.
    centre : float64 (S, 3)
        In the scene.
    focal : float64 (S, 2)
        Focal length in widths and in heights of the image.
    """

    rotation: np.ndarray
    centre: np.ndarray
    focal: np.ndarray

    def motion(self, view0: int, view1: int) -> np.ndarray:
        """Return the motion [R | t], float64 (3, 4), from the axes of one camera to those of another."""
        back = self.rotation[view1].T
        shift = back @ (self.centre[view0] - self.centre[view1])
        return np.column_stack([back @ self.rotation[view0], shift])


def decode_cameras(encoded: np.ndarray) -> SceneCameras:
    """Return the cameras of centres, quaternions and fields of view, floating (S, 9).

    A quaternion of length 0 gives a rotation of NaN.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025, section 3.
    """
    encoded = encoded.astype(np.float64)
    tangent = np.maximum(np.tan(encoded[:, [8, 7]] / 2), _SMALLEST_TANGENT)
    return SceneCameras(_rotation_of(encoded[:, 3:7]), encoded[:, :3], 0.5 / tangent)


def _rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """Return rotations (S, 3, 3) of quaternions (S, 4) of any length, real part last."""
    with np.errstate(invalid="ignore", divide="ignore"):
        x, y, z, w = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)
