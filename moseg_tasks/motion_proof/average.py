"""Average of a map along the flow, over past and future."""

from collections.abc import Sequence

import numpy as np

from moseg.tasks.half_floats import to_float32
from moseg.tasks.saliency.accumulation import accumulate


def average_along_flow(maps: Sequence[np.ndarray], flows: Sequence[np.ndarray], memory: float) -> np.ndarray:
    """Return the mean of a pass from the past and one from the future over a run of frames.

    Parameters
    ----------
    maps : T of float32 (y, x)
    flows : T of float32 (2, y, x, 2)
        From each frame to the previous and to the next one, px/frame.
    memory : float
        Weight of the frame before in each pass, 0..1.

    Returns
    -------
    average : float32 (T, y, x)
    """
    weights = [memory] * len(maps)
    past = accumulate(maps, (flow[0] for flow in flows), weights)
    future = accumulate(maps[::-1], (flow[1] for flow in flows[::-1]), weights)[::-1]
    return np.stack([(to_float32(before) + to_float32(after)) / 2 for before, after in zip(past, future, strict=True)])
