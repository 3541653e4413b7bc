"""Threshold on the flow that a homography does not explain."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from dense_flow import flow_of_each
from frame_size import LONGER_SIDE, cleaned, reduced
from registration import robust_homography

STEP = 8
"""Distance of the points to which the homography is fitted, px."""
MIN_RESIDUAL = 0.5
"""Smallest threshold, px: below it the residual is noise."""


def segment(frames: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the mask bool (y, x) where the flow's residual under a robust homography exceeds Otsu's threshold."""
    for flow in flow_of_each(frames):
        residual = residual_of(reduced([flow], LONGER_SIDE)[0], flow.shape[1])
        top = max(float(np.quantile(residual, 0.999)), MIN_RESIDUAL)
        levels = np.minimum(255 * residual / top, 255).astype(np.uint8)
        threshold, _ = cv2.threshold(levels, 0, 255, cv2.THRESH_OTSU)
        yield cleaned(residual > max(threshold * top / 255, MIN_RESIDUAL), flow.shape[:2])


def residual_of(flow: np.ndarray, width: int) -> np.ndarray:
    """Return the length of the flow float32 (y, x, 2) that a homography of it leaves, px of frames of that width."""
    scale = flow.shape[1] / width
    y, x = np.mgrid[: flow.shape[0], : flow.shape[1]].astype(np.float32) / scale
    points0 = np.stack([x, y], axis=-1)
    sample = np.s_[STEP // 2 :: STEP, STEP // 2 :: STEP]
    homography = robust_homography(points0[sample].reshape(-1, 2), (points0 + flow)[sample].reshape(-1, 2))
    if homography is None:
        return np.linalg.norm(flow - np.median(flow, axis=(0, 1)), axis=-1)
    moved = cv2.perspectiveTransform(points0, homography)
    return np.linalg.norm(points0 + flow - moved, axis=-1)
