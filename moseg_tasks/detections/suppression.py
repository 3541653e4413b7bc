"""Non-maximum suppression of boxes."""

import numpy as np


def suppress_boxes(
    boxes: np.ndarray, scores: np.ndarray, max_iou: float, groups: np.ndarray | None = None
) -> np.ndarray:
    """Return the boxes that do not overlap a better box that is kept.

    Parameters
    ----------
    boxes : floating (n, 4)
        Left, top, right, bottom, px.
    scores : floating (n,)
        Of equal scores, the first is better.
    max_iou : float
        Intersection over union above which the worse box is dropped.
    groups : int (n,), optional
        Only boxes of one group compete.

    Returns
    -------
    kept : intp (m,)
        Indices, best score first.
    """
    boxes = np.asarray(boxes, np.float64)
    areas = (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])
    waiting = np.argsort(-np.asarray(scores), kind="stable")
    kept = []
    while len(waiting):
        best, waiting = waiting[0], waiting[1:]
        kept.append(best)
        low = np.maximum(boxes[best, :2], boxes[waiting, :2])
        high = np.minimum(boxes[best, 2:], boxes[waiting, 2:])
        shared = np.prod(np.maximum(high - low, 0), axis=1)
        union = areas[best] + areas[waiting] - shared
        competes = shared > max_iou * union
        if groups is not None:
            competes &= groups[waiting] == groups[best]
        waiting = waiting[~competes]
    return np.array(kept, np.intp)
