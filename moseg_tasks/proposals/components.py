"""Objects as scored space-time components of the foreground."""

from typing import NamedTuple

import cv2
import numpy as np
from scipy import ndimage

from moseg.schemas.parameters import ComponentParams

FOREGROUND = 0.5
"""Probability above which a pixel belongs to an object."""
# Eight neighbours within a frame, and the same pixel of adjacent frames.
_CONNECTIVITY = np.zeros((3, 3, 3), bool)
_CONNECTIVITY[1] = True
_CONNECTIVITY[:, 1, 1] = True


class Components(NamedTuple):
    """Objects of a section on the working grid, numbered 1.. by falling score.

    Attributes
    ----------
    labels : uint16 (T, h, w)
        Object of each pixel, 0 = background.
    scores : float64 (object,)
        Sum of the probability over the object's pixels, reduced by its share of the frame's border.
    """

    labels: np.ndarray
    scores: np.ndarray


def label_components(foreground: np.ndarray, params: ComponentParams) -> np.ndarray:
    """Label the connected space-time parts of where `foreground` (T, h, w) is over a half: int32 (T, h, w), 0 = none.

    Specks below the minimal mean area of a single frame are dropped.
    """
    labels, count = ndimage.label(foreground > FOREGROUND, _CONNECTIVITY)
    large = np.bincount(labels.ravel(), minlength=count + 1) >= params.min_area * labels[0].size
    large[0] = False
    return np.where(large, np.cumsum(large), 0).astype(np.int32)[labels]


def keep_best(foreground: np.ndarray, labels: np.ndarray, params: ComponentParams) -> Components:
    """Return those of the components that are objects.

    Parameters
    ----------
    foreground : float16 or float32 (T, h, w)
        Probability to move, 0..1.
    labels : integer (T, h, w)
        Component of each pixel, 0 = none.
    params : ComponentParams

    Returns
    -------
    Components
    """
    scores, is_clear = _score(foreground, labels, int(labels.max(initial=0)), params)
    return _numbered(labels, scores, _best(scores, is_clear, params))


def keep_parts(foreground: np.ndarray, kept: Components, part: np.ndarray, params: ComponentParams) -> Components:
    """Return the objects and those of their parts that would be kept if they were alone.

    Parameters
    ----------
    foreground : float16 or float32 (T, h, w)
        Probability to move, 0..1.
    kept : Components
        As `keep_best` returns them.
    part : integer (T, h, w)
        Part of each pixel that may be an object of its own, over all objects, 0 = none. The other parts, and those
        beyond `params.max_objects`, stay in their object.
    params : ComponentParams

    Returns
    -------
    Components
    """
    count = len(kept.scores)
    present = np.unique(part[(kept.labels > 0) & (part > 0)])
    if len(present) == 0:
        return kept
    number = np.zeros(int(part.max()) + 1, np.int64)
    number[present] = count + 1 + np.arange(len(present))
    parted = np.where((kept.labels > 0) & (part > 0), number[part], kept.labels)
    scores, is_clear = _score(foreground, parted, count + len(present), params)
    good = _best(scores, is_clear, params)
    good = good[good >= count][: max(params.max_objects - count, 0)]
    is_object = np.zeros(len(scores) + 1, bool)
    is_object[good + 1] = True
    labels = np.where(is_object[parted], parted, kept.labels)
    scores, _ = _score(foreground, labels, len(scores), params)
    order = np.argsort(-scores, kind="stable")
    return _numbered(labels, scores, order[np.isin(order + 1, labels)])


def _numbered(labels: np.ndarray, scores: np.ndarray, kept: np.ndarray) -> Components:
    """Return the components of indices `kept`, from 0, numbered in this order."""
    relabel = np.zeros(len(scores) + 1, np.uint16)
    relabel[kept + 1] = np.arange(1, len(kept) + 1)
    return Components(np.stack([relabel[frame] for frame in labels]), scores[kept])


def _score(
    foreground: np.ndarray, labels: np.ndarray, count: int, params: ComponentParams
) -> tuple[np.ndarray, np.ndarray]:
    """Return the scores float64 (count,) of components 1..count, and which are clear by themselves, bool (count,).

    The score is the sum of the probability over its pixels, times max(0, 1 - share of its outline on the frame's
    border / `border_share`), over the frames that it does not fill; 0 if it fills all, or below the minimal mean area.
    A small object beside a large one has a low score, however
    sure it is: it is clear if its mean probability is high for long enough.
    """
    num_frames, height, width = labels.shape
    mass, area, perimeter, border, duration = np.zeros((5, count + 1))
    edge = np.zeros((height, width), bool)
    edge[[0, -1], :] = edge[:, [0, -1]] = True
    for t in range(num_frames):
        label = labels[t]
        inside = label > 0
        if not inside.any():
            continue
        present = label[inside]
        mass += np.bincount(present, foreground[t][inside], count + 1)
        counts = np.bincount(present, minlength=count + 1)
        area += counts
        duration += counts > 0
        inner = cv2.erode(inside.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
        # The outline of what fills the frame is the border, whatever it is.
        shows_outline = counts < params.full_frame * height * width
        perimeter += shows_outline * np.bincount(label[inside & ~inner], minlength=count + 1)
        border += shows_outline * np.bincount(label[inside & edge], minlength=count + 1)
    share = np.where(perimeter > 0, border / np.maximum(perimeter, 1), 1)
    score = mass * np.clip(1 - share / params.border_share, 0, None)
    score[area < params.min_area * height * width * duration] = 0
    is_clear = mass >= params.own_probability * np.maximum(area, 1)
    is_clear &= duration >= min(params.own_frames, num_frames)
    return score[1:], is_clear[1:]


def _best(scores: np.ndarray, is_clear: np.ndarray, params: ComponentParams) -> np.ndarray:
    """Return the indices of the components worth keeping, best first: clear ones, or good ones beside the best."""
    order = np.argsort(-scores, kind="stable")[: params.max_objects]
    top = scores[order[0]] if len(order) else 0.0
    return order[(scores[order] > 0) & (is_clear[order] | (scores[order] >= params.score_ratio * top))]
