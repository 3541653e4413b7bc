"""Lucas-Kanade from one frame to the next, from a second start where the first does not lead back."""

import cv2
import numpy as np

from moseg.schemas.parameters import DenseTrackParams

_STOP = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 30, 0.01)
"""OpenCV's default: 30 iterations or a step below 0.01 px."""
_LOST = 1e3
"""Forward-backward error of a point that the tracker lost, px."""


def follow_both_ways(
    gray0: np.ndarray,
    gray1: np.ndarray,
    points: np.ndarray,
    flow_forward: np.ndarray,
    flow_backward: np.ndarray,
    params: DenseTrackParams,
) -> tuple[np.ndarray, np.ndarray]:
    """Track points from frame 0 to frame 1 and return each point's better result of two.

    One starts from the dense flow: it finds small objects that move fast, which coarse levels of a pyramid do not show.
    The other starts from a coarse pyramid: it recovers where the dense flow is smoothed over an outline. It is tried
    where the first does not lead back to within `params.doubtful`.

    Parameters
    ----------
    gray0, gray1 : uint8 (y, x)
    points : float32 (N, 2)
        xy in frame 0, px.
    flow_forward, flow_backward : float32 (y, x, 2)
        From frame 0 to 1 and back, px/frame; finite.
    params : DenseTrackParams

    Returns
    -------
    points : float32 (N, 2)
        xy in frame 1, px.
    error : float32 (N,)
        Distance between the start and the point tracked back, px.

    References
    ----------
    J.-Y. Bouguet, Pyramidal implementation of the Lucas-Kanade feature tracker, Intel 2001;
    Z. Kalal, K. Mikolajczyk and J. Matas, Forward-backward error, ICPR 2010.
    """
    if len(points) == 0:
        return points, np.zeros(0, np.float32)
    levels = params.guided_levels
    guided = _follow(gray0, gray1, points, points + _sample(flow_forward, points), levels, params)
    back = _follow(gray1, gray0, guided[0], guided[0] + _sample(flow_backward, guided[0]), levels, params)
    found, error = guided[0], _closing_error(points, guided, back)
    doubtful = np.flatnonzero(error > params.doubtful)
    if len(doubtful):
        start = points[doubtful]
        free = _follow(gray0, gray1, start, None, params.pyramid_levels, params)
        back = _follow(gray1, gray0, free[0], None, params.pyramid_levels, params)
        free_error = _closing_error(start, free, back)
        better = free_error < error[doubtful]
        found[doubtful[better]], error[doubtful[better]] = free[0][better], free_error[better]
    return found, error


def _follow(gray0, gray1, points, start, levels: int, params: DenseTrackParams) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (N, 2) in frame 1 and whether each was found (N,), from `start` or from `points` themselves."""
    flags = 0 if start is None else cv2.OPTFLOW_USE_INITIAL_FLOW
    window = (params.window, params.window)
    found, status, _ = cv2.calcOpticalFlowPyrLK(
        gray0, gray1, points, start, winSize=window, maxLevel=levels, criteria=_STOP, flags=flags
    )
    return found, status.ravel() > 0


def _closing_error(points, forward, back) -> np.ndarray:
    """Return the distance (N,) from `points` to those tracked back, `_LOST` where either way failed."""
    return np.where(forward[1] & back[1], np.linalg.norm(back[0] - points, axis=1), np.float32(_LOST))


def _sample(flow: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the flow at points (N, 2), px, linear between pixels: float32 (N, 2)."""
    x, y = np.ascontiguousarray(points.T)
    return cv2.remap(flow, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).reshape(-1, 2)
