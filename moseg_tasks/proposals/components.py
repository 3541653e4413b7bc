"""Object proposals: scored space-time components of accumulated saliency."""

from typing import NamedTuple

import cv2
import numpy as np
from scipy import ndimage

from moseg_tasks.proposals.boxes import object_boxes
from schemas.parameters import ProposalParams

# Within a frame the eight neighbours touch; from frame to frame only the same pixel.
_CONNECTIVITY = np.zeros((3, 3, 3), bool)
_CONNECTIVITY[1] = True
_CONNECTIVITY[:, 1, 1] = True


class Proposals(NamedTuple):
    """Objects of a section, numbered 1.. by falling score.

    Attributes
    ----------
    masks : uint16 (T, H, W)
        Object of each pixel, 0 = background.
    scores : float64 (object,)
        Sum of saliency over the object's pixels of the working grid, lessened by what lies on the frame's border.
    boxes : int32 (object, T, 4)
        x0, y0, x1, y1 px, the last column and row excluded; -1 where the object is absent.
    """

    masks: np.ndarray
    scores: np.ndarray
    boxes: np.ndarray


def propose_objects(accumulated: np.ndarray, shape: tuple[int, int], params: ProposalParams) -> Proposals:
    """Connected space-time parts of the accumulated saliency, each a tracked object.

    Parameters
    ----------
    accumulated : float32 (T, h, w)
        0..1 on the working grid.
    shape : (int, int)
        Height H and width W of the full frame, px.
    params : ProposalParams

    Returns
    -------
    Proposals
    """
    labels, count = ndimage.label(accumulated > params.threshold, _CONNECTIVITY)
    scores = score_components(accumulated, labels, count, params)
    kept = _best(scores, params)
    relabel = np.zeros(count + 1, np.uint16)
    relabel[kept + 1] = np.arange(1, len(kept) + 1)
    masks = np.zeros((len(accumulated), *shape), np.uint16)
    for t, mask in enumerate(masks):
        mask[:] = _enlarge(relabel[labels[t]], accumulated[t], shape, params.threshold)
    return Proposals(masks, scores[kept], object_boxes(masks, len(kept)))


def score_components(accumulated: np.ndarray, labels: np.ndarray, count: int, params: ProposalParams) -> np.ndarray:
    """Score float64 (count,) of the components labelled 1..count.

    Sum over its pixels of P, the logistic of `sharpness` times (logit A - logit threshold), times
    max(0, 1 - share of its outline on the frame's border / `border_share`); 0 below the least mean area.
    """
    num_frames, height, width = labels.shape
    mass, area, perimeter, border, duration = np.zeros((5, count + 1))
    edge = np.zeros((height, width), bool)
    edge[[0, -1], :] = edge[:, [0, -1]] = True
    for t in range(num_frames):
        label, saliency = labels[t], accumulated[t].astype(np.float64)
        inside = label > 0
        if not inside.any():
            continue
        present = label[inside]
        odds = (saliency[inside] / np.maximum(1 - saliency[inside], 1e-6)) * (1 - params.threshold) / params.threshold
        mass += np.bincount(present, odds**params.sharpness / (1 + odds**params.sharpness), count + 1)
        counts = np.bincount(present, minlength=count + 1)
        area += counts
        duration += counts > 0
        inner = cv2.erode(inside.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
        perimeter += np.bincount(label[inside & ~inner], minlength=count + 1)
        border += np.bincount(label[inside & edge], minlength=count + 1)
    share = border / np.maximum(perimeter, 1)
    score = mass * np.clip(1 - share / params.border_share, 0, None)
    score[area < params.min_area * height * width * duration] = 0
    return score[1:]


def _best(scores: np.ndarray, params: ProposalParams) -> np.ndarray:
    """Indices of the components worth keeping, best first."""
    order = np.argsort(-scores, kind="stable")[: params.max_objects]
    top = scores[order[0]] if len(order) else 0.0
    return order[(scores[order] > 0) & (scores[order] >= params.score_ratio * top)]


def _enlarge(objects: np.ndarray, saliency: np.ndarray, shape: tuple[int, int], threshold: float) -> np.ndarray:
    """Objects at full size: outlines from the enlarged soft map, labels from the nearest object."""
    height, width = shape
    if not objects.any():
        return np.zeros((height, width), np.uint16)
    # The soft outline may lie up to a cell outside the labelled cells.
    grown = np.where(objects > 0, objects, cv2.dilate(objects, np.ones((3, 3), np.uint8)))
    soft = cv2.resize(saliency, (width, height), interpolation=cv2.INTER_LINEAR)
    nearest = cv2.resize(grown, (width, height), interpolation=cv2.INTER_NEAREST)
    return np.where(soft > threshold, nearest, 0).astype(np.uint16)
