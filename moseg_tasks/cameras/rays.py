"""Cameras of several views from the rays of their pixels."""

import numpy as np

from moseg.schemas.errors import InputError
from moseg.tasks.cameras.scene_cameras import SceneCameras
from moseg.tasks.saliency.background import tukey_weight

_NEAR_PLANE = 1e-4
"""Least part of a direction along the scene's first axis of depth, as in the authors' code."""
_TOLERANCE = 0.2
"""Deviation of a direction from which it counts for nothing, in focal lengths of the scene, as in the authors' code."""
_ROUNDS = 5
_MINIMAL_SAMPLE = 4


def cameras_of_rays(rays: np.ndarray) -> SceneCameras:
    """Return the cameras of rays, float32 (S, 7, y, x), at the centres of a grid of cells that fills each image.

    With the pixel p in halves of the image, a direction is R diag(1/f) p up to a factor: a homography, found by least
    squares whose weights are the confidences, and then by Tukey's biweight. The authors draw samples instead, and
    allow for a principal point beside the middle. The centre is the mean of the rays' origins by confidence.

    Parameters
    ----------
    rays : floating (S, 7, y, x)
        Direction, origin, and logarithm of the confidence minus 1.

    Raises
    ------
    InputError
        Rays are not finite, or determine no camera.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025, section 3.
    """
    rows, columns = rays.shape[2:]
    x, y = ((2 * np.arange(side) + 1 - side) / side for side in (columns, rows))
    places = np.stack([*(grid.ravel() for grid in np.meshgrid(x, y)), np.ones(rows * columns)], axis=1)
    found = [_camera_of_rays(view.reshape(7, -1).T.astype(np.float64), places) for view in rays]
    return SceneCameras(*(np.stack(part) for part in zip(*found, strict=True)))


def _camera_of_rays(rays: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the rotation, centre and focal length of one view's rays (N, 7) at places (N, 3)."""
    direction, origin, confidence = rays[:, :3], rays[:, 3:6], np.exp(rays[:, 6]) + 1
    centre = confidence @ origin / confidence.sum()
    ahead = np.abs(direction[:, 2]) > _NEAR_PLANE
    if not np.isfinite(rays).all() or np.count_nonzero(ahead) <= _MINIMAL_SAMPLE:
        raise InputError("rays determine no camera", got=f"{np.count_nonzero(ahead)} rays ahead")
    homography = _fit_homography(places[ahead], direction[ahead, :2] / direction[ahead, 2:], confidence[ahead])
    length = np.linalg.norm(homography, axis=0)
    left, _, right = np.linalg.svd(homography / length)
    # The nearest rotation; a homography has no sign.
    rotation = left @ right
    return rotation * np.sign(np.linalg.det(rotation)), centre, length[2] / length[:2] / 2


def _fit_homography(places: np.ndarray, seen: np.ndarray, confidence: np.ndarray) -> np.ndarray:
    """Return the homography (3, 3) from places (N, 3) to points (N, 2)."""
    nothing = np.zeros_like(places)
    by_x = np.hstack([places, nothing, -seen[:, :1] * places])
    by_y = np.hstack([nothing, places, -seen[:, 1:] * places])
    weight = confidence
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)[:, None]
        homography = np.linalg.svd(np.vstack([by_x * root, by_y * root]), full_matrices=False)[2][-1].reshape(3, 3)
        moved = places @ homography.T
        moved = moved[:, :2] / np.where(np.abs(moved[:, 2:]) < _NEAR_PLANE, _NEAR_PLANE, moved[:, 2:])
        if np.count_nonzero(np.linalg.norm(moved - seen, axis=1) < _TOLERANCE) < _MINIMAL_SAMPLE:
            break
        weight = confidence * tukey_weight(np.linalg.norm(moved - seen, axis=1), _TOLERANCE)
    return homography
