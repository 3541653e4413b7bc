"""The affine motion of the salient pixels, and each pixel's misfit to it."""

from collections.abc import Sequence

import cv2
import numpy as np

from moseg.schemas.parameters import OwnMotionParams
from moseg.tasks.saliency.background import MAD_TO_SIGMA, AffineMotion, affine_flow, is_settled, tukey_weight
from moseg.tasks.saliency.grid import vector_length

_RIDGE = 1e-6  # keeps the fit solvable where Tukey's weights are all 0


def own_motion_misfit(
    residual_flows: Sequence[np.ndarray | None], weight: np.ndarray, params: OwnMotionParams
) -> np.ndarray:
    """Measure the deviation of each pixel of a frame from the motion that most of the salient pixels follow.

    A rigid object has a small misfit throughout. Water, spray and leaves move too, but not uniformly. A salient region
    that is apart from the others may be another object with a motion of its own: there, the smaller deviation counts.

    Parameters
    ----------
    residual_flows : two of float32 (y, x, 2) or None
        Flow to the previous and to the next frame less the background's, px/frame; None at the video's ends.
    weight : float32 (y, x)
        Weight of each pixel in the fit, 0..1: its probability to move.
    params : OwnMotionParams

    Returns
    -------
    misfit : float32 (y, x)
        ``log(1 + (d / s)^2)`` with the smaller deviation d of both directions and the spread s of the salient pixels;
        0 if nothing is salient.
    """
    deviation = None
    for flow in residual_flows:
        motion = None if flow is None else _fit_own_motion(flow, weight, params, params.step)
        if motion is not None:
            left = vector_length(flow - affine_flow(motion, flow.shape[:2]))
            left = _follow_regions(left, flow, weight, params)
            deviation = left if deviation is None else np.minimum(deviation, left)
    if deviation is None:
        return np.zeros(weight.shape, np.float32)
    some = (slice(None, None, params.spread_step),) * 2
    spread = max(params.spread_floor, _weighted_quantile(deviation[some].ravel(), weight[some].ravel(), params.spread))
    return np.log1p((deviation / np.float32(spread)) ** 2)


def _follow_regions(left: np.ndarray, flow: np.ndarray, weight: np.ndarray, params: OwnMotionParams) -> np.ndarray:
    """Return the deviation `left` float32 (y, x), in salient regions that are apart at most that from their own motion.

    The spread by which deviations are divided stays that of all salient pixels, so that a region of water, whose
    motion is not uniform, keeps a large misfit.
    """
    salient = (weight > params.salient_share * weight.max(initial=0)).astype(np.uint8)
    count, regions, stats, _ = cv2.connectedComponentsWithStats(salient, connectivity=8)
    if count <= 2:
        return left
    areas = stats[1:, cv2.CC_STAT_AREA]
    largest = np.argsort(-areas, kind="stable")[: params.regions]
    left = left.copy()
    for region in largest[areas[largest] >= params.region_area * weight.size] + 1:
        inside = regions == region
        # Relative weights: a region is judged by itself, however much more salient another one is.
        relative = np.where(inside, weight / weight[inside].max(), 0)
        motion = _fit_own_motion(flow, relative, params, params.region_step)
        if motion is not None:
            own = vector_length(flow[inside] - affine_flow(motion, flow.shape[:2])[inside])
            left[inside] = np.minimum(left[inside], own)
    return left


def _fit_own_motion(flow: np.ndarray, weight: np.ndarray, params: OwnMotionParams, step: int) -> AffineMotion | None:
    """Fit a weighted robust affine motion from the weighted median vector; None where too little is salient."""
    on_grid = (slice(step // 2, None, step),) * 2
    some = weight[on_grid].astype(np.float64)
    rows, columns = np.nonzero(some > params.salient_share * some.max(initial=0.0))
    given = some[rows, columns]
    if given.sum() < params.least_weight:
        return None
    points = np.column_stack([columns, rows]) * step + step // 2
    vectors = flow[on_grid][rows, columns].astype(np.float64)
    centre = given @ points / given.sum()
    design = np.column_stack([np.ones(len(points)), points - centre])
    prior = np.diag([_RIDGE, params.slope_prior, params.slope_prior])
    theta = np.zeros((3, 2))
    theta[0] = [_weighted_quantile(vectors[:, axis], given, 0.5) for axis in (0, 1)]
    scale, reach = params.scale_floor, np.abs(design[:, 1:]).max()
    for _ in range(params.iterations):
        error = vectors - design @ theta
        left = np.hypot(error[:, 0], error[:, 1])
        scale = max(params.scale_floor, MAD_TO_SIGMA * _weighted_quantile(left, given, 0.5))
        weighted = design * (given * tukey_weight(left, params.tukey_constant * scale))[:, None]
        previous, theta = theta, np.linalg.solve(weighted.T @ design + prior, weighted.T @ vectors)
        if is_settled(theta - previous, reach):
            break
    return AffineMotion(theta, centre, scale)


def _weighted_quantile(values: np.ndarray, weights: np.ndarray, share: float) -> float:
    """Return the smallest value below which at least `share` of the weight lies."""
    order = np.argsort(values)
    reached = np.cumsum(weights[order], dtype=np.float64)
    index = int(np.searchsorted(reached, share * reached[-1]))
    return float(values[order][min(index, len(values) - 1)])
