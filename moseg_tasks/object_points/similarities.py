"""Similarities: the motions of an object's points from one frame to the next, as shown and as expected."""

import cv2
import numpy as np

_MAX_ITERATIONS = 500
_CONFIDENCE = 0.999


def move(similarity: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return where a similarity float64 (2, 3) brings points (N, 2), px: float32 (N, 2)."""
    return (points @ similarity[:, :2].T + similarity[:, 2]).astype(np.float32)


def fit_similarity(
    points0: np.ndarray, points1: np.ndarray, tolerance: float, min_points: int
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the similarity that most pairs of points agree with, and with which each agrees.

    Parameters
    ----------
    points0, points1 : float32 (N, 2)
        xy in both frames, px.
    tolerance : px.
    min_points : fewest pairs that agree.

    Returns
    -------
    similarity : float64 (2, 3)
    agrees : bool (N,)
        Or None where fewer than `min_points` agree with any.

    References
    ----------
    M. Fischler and R. Bolles, Random sample consensus, CACM 1981; the draws have a fixed seed.
    """
    if len(points0) < min_points:
        return None
    similarity, agrees = cv2.estimateAffinePartial2D(
        points0,
        points1,
        method=cv2.RANSAC,
        ransacReprojThreshold=tolerance,
        maxIters=_MAX_ITERATIONS,
        confidence=_CONFIDENCE,
    )
    if similarity is None or np.count_nonzero(agrees) < min_points:
        return None
    return similarity, agrees.ravel() > 0


def fit_similarities(
    points0: np.ndarray, points1: np.ndarray, tolerance: float, min_points: int, most: int
) -> list[np.ndarray]:
    """Return up to `most` similarities, each the best of the points that agree with none before it."""
    found: list[np.ndarray] = []
    while len(found) < most:
        fitted = fit_similarity(points0, points1, tolerance, min_points)
        if fitted is None:
            break
        similarity, agrees = fitted
        found.append(similarity)
        points0, points1 = points0[~agrees], points1[~agrees]
    return found


def expect_next(similarity: np.ndarray, centre: np.ndarray, max_growth: float) -> np.ndarray:
    """Return the similarity that follows one in time, if what is seen has a constant velocity in space.

    A thing at depth Z that comes nearer by D in each frame grows by s = Z / (Z - D), and then by 1 / (2 - s). Its
    direction X / Z becomes s (X / Z + T / Z) with the velocity T along the image plane, and T / Z has grown by s in the
    next frame, too.

    Parameters
    ----------
    similarity : float64 (2, 3)
        Between the last two frames, px.
    centre : float64 (2,)
        Principal point, xy, px.
    max_growth : float
        Below 2; faster growth counts as this.

    Returns
    -------
    float64 (2, 3)
        Without rotation.
    """
    linear = similarity[:, :2]
    growth = min(np.sqrt(max(np.linalg.det(linear), 0.0)), max_growth)
    shift = linear @ centre + similarity[:, 2] - centre
    next_growth = 1 / (2 - growth)
    # The shift is s T / Z; the next one is s' s T / Z.
    expected = np.empty((2, 3))
    expected[:, :2] = next_growth * np.eye(2)
    expected[:, 2] = centre + next_growth * shift - next_growth * centre
    return expected
