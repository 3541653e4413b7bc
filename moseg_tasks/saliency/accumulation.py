"""Accumulation of saliency along the flow, over both time directions."""

import cv2
import numpy as np

from moseg_tasks.saliency.grid import pixel_grid
from schemas.parameters import ProposalParams

PREVIOUS, NEXT = 0, 1


def accumulate_saliency(saliency: np.ndarray, flows: np.ndarray, params: ProposalParams) -> np.ndarray:
    """Saliency with a memory that follows the flow: mean of a pass forward and a pass backward in time.

    ``A_t = w warp(A_{t-1}) + (1 - w) S_t`` where w grows with the forward-backward consistency of the flow, and where
    the flow is consistent neither way the frame's own saliency hardly counts.

    Parameters
    ----------
    saliency : float32 (T, h, w)
        0..1.
    flows : float32 (T, 2, h, w, 2)
        To the previous and to the next frame, px/frame of the same grid.
    params : ProposalParams

    Returns
    -------
    accumulated : float32 (T, h, w)
        0..1.
    """
    num_frames = len(saliency)
    grid = pixel_grid(saliency.shape[1:])
    consistency = np.zeros((2, *saliency.shape), np.float32)
    for t in range(1, num_frames):
        consistency[PREVIOUS, t] = _consistency(flows[t, PREVIOUS], flows[t - 1, NEXT], grid, params)
        consistency[NEXT, t - 1] = _consistency(flows[t - 1, NEXT], flows[t, PREVIOUS], grid, params)
    reliability = params.reliability_floor + (1 - params.reliability_floor) * consistency.max(axis=0)
    accumulated = np.zeros_like(saliency)
    for direction, order in ((PREVIOUS, range(num_frames)), (NEXT, range(num_frames - 1, -1, -1))):
        memory = None
        for t in order:
            if memory is None:
                memory = saliency[t]
            else:
                kept = params.memory * np.maximum(consistency[direction, t], params.consistency_floor)
                weight = 1 - (1 - kept) * reliability[t]
                memory = weight * _warp(memory, flows[t, direction], grid) + (1 - weight) * saliency[t]
            accumulated[t] += memory / 2
    return accumulated


def _consistency(flow: np.ndarray, back: np.ndarray, grid: np.ndarray, params: ProposalParams) -> np.ndarray:
    """exp(-|f + b|^2 / (relative (|f|^2 + |b|^2) + absolute)), b read where f leads; 0 outside the frame."""
    returned = cv2.remap(back, grid + flow, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    error = _squared_length(flow + returned)
    allowed = params.consistency_relative * (_squared_length(flow) + _squared_length(returned))
    return np.exp(-error / (allowed + params.consistency_absolute))


def _squared_length(flow: np.ndarray) -> np.ndarray:
    return flow[..., 0] ** 2 + flow[..., 1] ** 2


def _warp(image: np.ndarray, flow: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """`image` read where `flow` leads from each pixel."""
    return cv2.remap(image, grid + flow, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
