"""Dense flow of each frame of a clip (DIS)."""

from collections.abc import Iterator, Sequence

import numpy as np

from moseg.schemas.parameters import FlowParams
from moseg.tasks.flow import estimate_flow

_PARAMS = FlowParams(preset="medium", search_side=427, coarse_side=0)


def flow_of_each(frames: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the flow float32 (y, x, 2) of each frame to the next one, of the last frame to the one before it, px."""
    for t, frame in enumerate(frames):
        other = frames[t + 1] if t + 1 < len(frames) else frames[t - 1]
        yield estimate_flow(frame, other, _PARAMS)
