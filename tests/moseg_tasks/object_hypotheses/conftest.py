"""A rigid scene seen by a moving camera, as flow and as tracks, with one object that moves on its own."""

import numpy as np
import pytest

from moseg.tasks.motion_models.monomials import image_coordinates

HEIGHT, WIDTH = 96, 128
CAMERA, MOVER = ((0.3, -0.1, 0.4), (0.01, -0.02, 0.02)), ((-0.6, 0.5, 0.1), (0.0, 0.01, -0.03))


@pytest.fixture(scope="session")
def owner() -> np.ndarray:
    """Background, a static object (1) and a mover (2) of the same size."""
    owner = np.zeros((HEIGHT, WIDTH), np.uint16)
    owner[50:80, 20:50] = 1
    owner[50:80, 80:110] = 2
    return owner


@pytest.fixture(scope="session")
def inverse_depth(owner) -> np.ndarray:
    """Rising ground with bumps; both objects stand before it at the same depth."""
    rng = np.random.default_rng(0)
    bumps = rng.random((6, 8)).repeat(16, axis=0).repeat(16, axis=1)
    ground = 0.2 + 0.2 * np.maximum(np.linspace(-1, 1, HEIGHT)[:, None], 0) + 0.1 * bumps
    return np.where(owner > 0, 0.5 + 0.05 * bumps, ground).astype(np.float32)


@pytest.fixture(scope="session")
def flow(owner, inverse_depth) -> np.ndarray:
    """Instantaneous flow (Longuet-Higgins and Prazdny), float32 (H, W, 2), px."""
    x, y = np.meshgrid(*image_coordinates(HEIGHT, WIDTH))

    def of(motion):
        (tx, ty, tz), (wx, wy, wz) = motion
        u = (-tx + x * tz) * inverse_depth + wx * x * y - wy * (1 + x * x) + wz * y
        v = (-ty + y * tz) * inverse_depth + wx * (1 + y * y) - wy * x * y - wz * x
        return WIDTH / 2 * np.stack([u, v], axis=-1)

    return np.where((owner == 2)[..., None], of(MOVER), of(CAMERA)).astype(np.float32)
