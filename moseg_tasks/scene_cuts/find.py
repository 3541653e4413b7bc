"""Cuts of a video, by changes that stand out and that no motion explains."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import cv2
import numpy as np

from moseg.schemas.parameters import FlowParams, SceneCutParams
from moseg.tasks.flow.dis import estimate_flow
from moseg.tasks.saliency.grid import vector_length, warp

_FLOW = FlowParams(preset="fast", search_side=16, coarse_side=0)
_NEAR = 2.0  # px of the reduced frames: deviation of the weights of local contrast
_NEARLY_ALL = 99  # per cent of the pixels of a plain frame
_SHOWS_AGAIN = 2.0  # times the contrast of a plain frame, so that a dark scene near it is not cut again and again


def find_cuts(images: Iterable[np.ndarray], params: SceneCutParams) -> list[int]:
    """Find the frames that begin another scene.

    A frame does if it changes more than the frames around it, and if the pixels of the frame before are not found
    again: the camera's turn at once changes much, too, but is seen by the flow; fast motion is not, but lasts. Plain
    frames, to which scenes fade, are a scene of their own however slowly they come.

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
        if stands_out and consistent_share(small[index], small[index + 1], params) < params.max_consistent:
            found.append(index + 1)
    return sorted({*found, *_plain_bounds([_high_contrast(image) for image in small], params.max_plain)})


def _plain_bounds(contrasts: Sequence[float], max_plain: float) -> Iterator[int]:
    """Yield the indices at which plain frames begin, and those at which frames with a scene do after them."""
    was_plain = None
    for index, contrast in enumerate(contrasts):
        is_plain = contrast < (_SHOWS_AGAIN * max_plain if was_plain else max_plain)
        if was_plain is not None and is_plain != was_plain:
            yield index
        was_plain = is_plain


def consistent_share(image0: np.ndarray, image1: np.ndarray, params: SceneCutParams) -> float:
    """Return the share of the pixels of `image0` that are found again in `image1`.

    The flow there and back returns to them, and what is around them has not lost or gained most of its contrast: flow
    to a plain frame is zero, there and back.

    Parameters
    ----------
    image0, image1 : uint8 (y, x, 3)
    params : SceneCutParams
    """
    flow, back = estimate_flow(image0, image1, _FLOW), estimate_flow(image1, image0, _FLOW)
    returns = vector_length(flow + warp(back, flow)) <= params.max_error
    contrasts = _local_contrast(image0), warp(_local_contrast(image1), flow)
    high, low = np.maximum(*contrasts), np.minimum(*contrasts)
    differs = (high > params.min_contrast) & (high > params.max_contrast_ratio * low)
    return float((returns & ~differs).mean())


def _high_contrast(image: np.ndarray) -> float:
    """Return the local contrast that nearly all pixels are below."""
    return float(np.percentile(_local_contrast(image), _NEARLY_ALL))


def _local_contrast(image: np.ndarray) -> np.ndarray:
    """Return the deviation of grey levels around each pixel, float32 (y, x)."""
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY).astype(np.float32)
    mean, mean_square = (cv2.GaussianBlur(each, (0, 0), _NEAR) for each in (grey, grey * grey))
    return np.sqrt(np.maximum(mean_square - mean * mean, 0))


def _reduce(image: np.ndarray, side: int) -> np.ndarray:
    """Return a frame with a longer side of at most `side`, px."""
    factor = min(side / max(image.shape[:2]), 1)
    height, width = (max(round(factor * length), 1) for length in image.shape[:2])
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
