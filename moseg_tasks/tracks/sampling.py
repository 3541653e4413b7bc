"""New points inside an object's mask: Shi-Tomasi corners mixed with k-medoids."""

import cv2
import numpy as np

from moseg.schemas.parameters import TrackParams
from moseg.tasks.tracks.corners import strongest_corners
from moseg.tasks.tracks.medoids import covering_medoids


def sample_points(
    texture: np.ndarray, mask: np.ndarray, quota: int, taken: np.ndarray, params: TrackParams, rng: np.random.Generator
) -> np.ndarray:
    """Sample points until an object has its quota.

    Parameters
    ----------
    texture : float32 (y, x)
        Of `texture_strength`.
    mask : bool (y, x)
        The object.
    quota : int
        Number of points that the object should have.
    taken : float32 (M, 2)
        xy of its existing points, px.
    params : TrackParams
    rng : numpy.random.Generator

    Returns
    -------
    points : float32 (P, 2)
        xy at pixel centres, at least `params.border` from the frame's border; P <= quota - M.
    """
    missing = quota - len(taken)
    mask = interior(mask, params)
    area = int(mask.sum())
    if missing <= 0 or area == 0:
        return np.zeros((0, 2), dtype=np.float32)
    spacing = max(1.0, params.spread * np.sqrt(area / quota))
    textured = mask & (texture >= params.corner_quality * texture[mask].max())
    num_corners = round(params.corner_fraction * missing)
    corners = strongest_corners(texture, textured, num_corners, spacing=spacing, taken=taken)
    medoids = covering_medoids(
        textured,
        missing - len(corners),
        num_candidates=params.medoid_candidates,
        spacing=spacing,
        taken=np.concatenate([taken, corners]),
        rng=rng,
    )
    return np.concatenate([corners, medoids])


def interior(mask: np.ndarray, params: TrackParams) -> np.ndarray:
    """Return a mask without the frame's border and, where something is left, without its own outline."""
    height, width = mask.shape
    margin = params.border
    inside = np.zeros_like(mask)
    inside[margin : height - margin, margin : width - margin] = mask[margin : height - margin, margin : width - margin]
    if params.erosion == 0:
        return inside
    kernel = np.ones((2 * params.erosion + 1,) * 2, dtype=np.uint8)
    eroded = cv2.erode(inside.astype(np.uint8), kernel) > 0
    return eroded if eroded.any() else inside
