"""Registration of frames to each other by robust homographies of tracked corners."""

from collections.abc import Sequence

import cv2
import numpy as np

NUM_CORNERS = 1000
CORNER_QUALITY = 0.005
CORNER_DISTANCE = 8
"""Smallest distance between two corners, px."""
WINDOW, LEVELS = 21, 4
"""Side of the window of Lucas-Kanade, px, and levels of its pyramid."""
MAX_ROUND_TRIP = 0.5
"""Largest distance of a corner that was tracked there and back from its start, px."""
TOLERANCE = 1.5
"""Largest error of a corner that a homography explains, px."""
MIN_CORNERS = 12


class Registration:
    """Homographies between all frames of a clip, accumulated from those between neighbours.

    Parameters
    ----------
    frames : sequence of uint8 (y, x, 3)
        RGB. A frame in which too few corners can be tracked is taken as not moved.
    """

    def __init__(self, frames: Sequence[np.ndarray]):
        self._to_first = [np.eye(3)]
        gray0 = None
        for frame in frames:
            gray1 = cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY)
            if gray0 is not None:
                step = estimate_homography(gray1, gray0)
                self._to_first.append(self._to_first[-1] @ (np.eye(3) if step is None else step))
            gray0 = gray1

    def between(self, frame: int, target: int) -> np.ndarray:
        """Return the homography float64 (3, 3) from pixels of one frame to those of another."""
        homography = np.linalg.solve(self._to_first[target], self._to_first[frame])
        return homography / homography[2, 2]


def estimate_homography(gray0: np.ndarray, gray1: np.ndarray) -> np.ndarray | None:
    """Estimate the motion of the background between two frames by corners, Lucas-Kanade and MAGSAC.

    Parameters
    ----------
    gray0, gray1 : uint8 (y, x)

    Returns
    -------
    float64 (3, 3) or None
        Homography from pixels of `gray0` to those of `gray1`; None if too few corners can be tracked.
    """
    corners = cv2.goodFeaturesToTrack(gray0, NUM_CORNERS, CORNER_QUALITY, CORNER_DISTANCE)
    if corners is None or len(corners) < MIN_CORNERS:
        return None
    corners = corners.reshape(-1, 1, 2)
    options = {"winSize": (WINDOW, WINDOW), "maxLevel": LEVELS}
    there, found, _ = cv2.calcOpticalFlowPyrLK(gray0, gray1, corners, None, **options)
    back, found_back, _ = cv2.calcOpticalFlowPyrLK(gray1, gray0, there, None, **options)
    round_trip = np.linalg.norm((back - corners).reshape(-1, 2), axis=1)
    kept = (found.ravel() == 1) & (found_back.ravel() == 1) & (round_trip < MAX_ROUND_TRIP)
    if np.count_nonzero(kept) < MIN_CORNERS:
        return None
    points0, points1 = corners.reshape(-1, 2)[kept], there.reshape(-1, 2)[kept]
    return robust_homography(points0, points1)


def robust_homography(points0: np.ndarray, points1: np.ndarray) -> np.ndarray | None:
    """Fit a homography to points float32 (N, 2), px, by MAGSAC; None if they determine none."""
    homography, _ = cv2.findHomography(
        points0, points1, cv2.USAC_MAGSAC, ransacReprojThreshold=TOLERANCE, maxIters=2000, confidence=0.999
    )
    # An estimate that mirrors or folds the frame is no camera motion.
    if homography is None or not np.isfinite(homography).all() or np.linalg.det(homography[:2, :2]) <= 0:
        return None
    return homography


def warp(image: np.ndarray, homography: np.ndarray, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return an image drawn where the homography maps it, and the mask bool (y, x) of the pixels that it covers."""
    size = (width, height)
    inside = np.full(image.shape[:2], 255, np.uint8)
    covered = cv2.warpPerspective(inside, homography, size, flags=cv2.INTER_NEAREST) > 0
    return cv2.warpPerspective(image, homography, size, flags=cv2.INTER_LINEAR), covered
