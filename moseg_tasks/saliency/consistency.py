"""Forward-backward consistency of the flows of frames in a row."""

from collections.abc import Sequence

import cv2
import numpy as np

from moseg.schemas.parameters import AccumulationParams
from moseg.tasks.saliency.grid import squared_length, warp

PREVIOUS, NEXT = 0, 1


def flow_consistency(flows: Sequence[np.ndarray], params: AccumulationParams) -> np.ndarray:
    """Measure how well the flow from a neighbouring frame inverts the flow to it.

    Parameters
    ----------
    flows : T of float32 (2, y, x, 2)
        To the previous and to the next frame, px/frame, of frames in a row.
    params : AccumulationParams

    Returns
    -------
    consistency : float32 (T, 2, y, x)
        ``exp(-|f + b|^2 / (relative (|f|^2 + |b|^2) + absolute))`` in 0..1, with b read where f leads. The first frame,
        which has no previous one here, has the consistency to its next frame twice; the last one likewise.
    """
    num_frames = len(flows)
    consistency = np.ones((num_frames, 2, *flows[0].shape[1:3]), np.float32)
    for t in range(1, num_frames):
        to_previous, to_next = flows[t][PREVIOUS], flows[t - 1][NEXT]
        consistency[t, PREVIOUS] = _agreement(to_previous, to_next, params)
        consistency[t - 1, NEXT] = _agreement(to_next, to_previous, params)
    if num_frames > 1:
        consistency[0, PREVIOUS] = consistency[0, NEXT]
        consistency[-1, NEXT] = consistency[-1, PREVIOUS]
    return consistency


def _agreement(flow: np.ndarray, back: np.ndarray, params: AccumulationParams) -> np.ndarray:
    returned = warp(back, flow)
    allowed = params.consistency_relative * (squared_length(flow) + squared_length(returned))
    return cv2.exp(-squared_length(flow + returned) / (allowed + np.float32(params.consistency_absolute)))
