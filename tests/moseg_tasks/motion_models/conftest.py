"""Exact instantaneous flow of rigid motions over a scene of known inverse depth."""

from collections.abc import Callable

import numpy as np
import pytest

from moseg.tasks.motion_models.monomials import image_coordinates

HEIGHT, WIDTH = 90, 128


@pytest.fixture(scope="session")
def inverse_depth() -> np.ndarray:
    """Inverse depth (H, W), 1/m: rising ground, and boxes at several depths before it."""
    rng = np.random.default_rng(1)
    boxes = rng.random((6, 8)).repeat(15, axis=0).repeat(16, axis=1)
    y = np.linspace(-1, 1, HEIGHT)[:, None]
    return (0.1 + 0.2 * np.maximum(y, 0) + 0.3 * boxes * (boxes > 0.6)).astype(np.float32)


@pytest.fixture(scope="session")
def masks() -> np.ndarray:
    """Background and three objects, one of them thin; id 2 does not appear."""
    masks = np.zeros((HEIGHT, WIDTH), np.uint16)
    masks[10:40, 20:60] = 1
    masks[50:80, 70:120] = 3
    masks[np.arange(10, 80), np.arange(10, 80) + 30] = 4
    return masks


@pytest.fixture(scope="session")
def rigid_flow() -> Callable[..., np.ndarray]:
    """Longuet-Higgins and Prazdny's flow of a camera's motion, float64 (H, W, 2), px."""

    def flow(rho, translation, rotation, zoom=0.0, focal=1.7) -> np.ndarray:
        half = max(rho.shape) / 2
        x, y = (axis / focal for axis in np.meshgrid(*image_coordinates(*rho.shape)))
        (tx, ty, tz), (wx, wy, wz) = translation, rotation
        u = (-tx + x * tz) * rho + wx * x * y - wy * (1 + x * x) + wz * y + zoom * x
        v = (-ty + y * tz) * rho + wx * (1 + y * y) - wy * x * y - wz * x + zoom * y
        return focal * half * np.stack([u, v], axis=-1)

    return flow


@pytest.fixture(scope="session")
def motions() -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """A (translation, rotation) per object; motions of a few pixels a frame."""
    return [
        ((0.1, -0.05, 0.2), (0.01, -0.02, 0.03)),
        ((-0.3, 0.1, 0.05), (0.0, 0.01, -0.02)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        ((0.05, 0.2, -0.3), (-0.02, 0.0, 0.01)),
        ((0.2, 0.2, 0.1), (0.01, 0.01, 0.0)),
    ]
