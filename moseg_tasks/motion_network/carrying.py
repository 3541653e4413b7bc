"""Logits of the motion network for frames between those that it looks at."""

from collections.abc import Sequence

import cv2
import numpy as np

from moseg.tasks.frame_grid import flow_on_grid
from moseg.tasks.saliency.grid import warp


def carry_logits(logits: Sequence[np.ndarray], flows: Sequence[np.ndarray]) -> np.ndarray:
    """Carry the logits of neighbouring frames along the flow to a frame that the network did not look at.

    Parameters
    ----------
    logits : sequence of float32 (grid y, grid x)
        Of the frame before, of the frame after, or of both.
    flows : sequence of float32 (y, x, 2)
        From the frame to each of these, px/frame, on a grid that may be finer.

    Returns
    -------
    logit : float32 (grid y, grid x)
        Mean of what is carried.
    """
    carried = [warp(logit, flow_on_grid(flow, logit.shape)) for logit, flow in zip(logits, flows, strict=True)]
    return carried[0] if len(carried) == 1 else cv2.addWeighted(carried[0], 0.5, carried[1], 0.5, 0.0)
