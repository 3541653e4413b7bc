"""Cuts of a video, by changes that stand out and that no motion explains."""

from collections.abc import Iterable
from itertools import pairwise

import cv2
import numpy as np

from moseg.schemas.parameters import FlowParams, SceneCutParams
from moseg.tasks.flow.dis import estimate_flow
from moseg.tasks.saliency.grid import vector_length, warp

_FLOW = FlowParams(preset="fast")


def find_cuts(images: Iterable[np.ndarray], params: SceneCutParams) -> list[int]:
    """Find the frames that begin another scene.

    A frame does if it changes more than the frames around it, and if the flow from the frame before does not lead back:
    the camera's turn at once changes much, too, but is seen by the flow; fast motion is not, but lasts.

    Parameters
    ----------
    images : iterable of uint8 (y, x, 3)
        Frames of a video, or of a part of it that reaches a window farther than what is read of the result.
    params : SceneCutParams

    Returns
    -------
    cuts : list of int
        Indices of these frames.
    """
    small = [_reduce(image, params.side) for image in images]
    changes = [float(np.mean(cv2.absdiff(*pair))) for pair in pairwise(small)]
    found, length = [], params.window
    for index, change in enumerate(changes):
        around = changes[max(index - length, 0) : index] + changes[index + 1 : index + 1 + length]
        stands_out = bool(around) and change > params.min_change * max(around)
        if stands_out and consistent_share(small[index], small[index + 1], params.max_error) < params.max_consistent:
            found.append(index + 1)
    return found


def consistent_share(image0: np.ndarray, image1: np.ndarray, max_error: float) -> float:
    """Return the share of the pixels of `image0` that the flow to `image1`, and from there back, returns to.

    Parameters
    ----------
    image0, image1 : uint8 (y, x, 3)
    max_error : float
        Distance up to which a pixel has returned, px.
    """
    flow, back = estimate_flow(image0, image1, _FLOW), estimate_flow(image1, image0, _FLOW)
    return float((vector_length(flow + warp(back, flow)) <= max_error).mean())


def _reduce(image: np.ndarray, side: int) -> np.ndarray:
    """Return a frame with a longer side of at most `side`, px."""
    factor = min(side / max(image.shape[:2]), 1)
    height, width = (max(round(factor * length), 1) for length in image.shape[:2])
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
