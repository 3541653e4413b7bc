"""Accumulation of maps along the flow, in one pass over time."""

from collections.abc import Iterable

import numpy as np

from moseg.schemas.parameters import AccumulationParams
from moseg.tasks.half_floats import to_float16, to_float32
from moseg.tasks.saliency.grid import warp


def accumulate(
    maps: Iterable[np.ndarray],
    flows: Iterable[np.ndarray],
    weights: Iterable[np.ndarray | float],
    carried: np.ndarray | None = None,
) -> np.ndarray:
    """Accumulate maps along the flow: ``A_t = w_t warp(A_{t-1}) + (1 - w_t) S_t``.

    Frames are given in the order of the pass; `carried` is the result of the frame before the first, so that a video
    cut into parts gives the same result as the whole video.

    Parameters
    ----------
    maps : T of float32 (y, x) or (y, x, channel)
        S.
    flows : T of float32 (y, x, 2)
        From each frame to the one before it in the pass, px/frame.
    weights : T of float32, shaped as the maps, or float
        w, of the memory.
    carried : float16, shaped as the maps, optional
        A of the frame before the first; without it the pass begins with ``A = S``.

    Returns
    -------
    accumulated : float16 (T, y, x) or (T, y, x, channel)
        A. Each step starts from the rounded result, as does a step that reads it from a file.
    """
    accumulated = []
    memory = carried
    for seen, flow, weight in zip(maps, flows, weights, strict=True):
        if memory is not None:
            warped = warp(to_float32(memory), flow)
            seen = seen + weight * (warped - seen)
        memory = to_float16(seen)
        accumulated.append(memory)
    return np.stack(accumulated)


def memory_weight(consistency: np.ndarray, direction: int, params: AccumulationParams) -> np.ndarray:
    """Return the weight float32 (y, x) of one frame's memory, from its `consistency` (2, y, x) in both directions.

    It grows with the consistency of the flow along which the memory was warped; where the flow is consistent in neither
    direction, the frame's own saliency has little weight.
    """
    reliability = params.reliability_floor + (1 - params.reliability_floor) * consistency.max(axis=0)
    kept = params.memory * np.maximum(consistency[direction], np.float32(params.consistency_floor))
    return 1 - (1 - kept) * reliability
