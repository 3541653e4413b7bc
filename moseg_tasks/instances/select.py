"""Selection of the best masks among those of the same objects."""

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.instances import InstanceParams


def select_instances(masks: np.ndarray, scores: np.ndarray, params: InstanceParams) -> np.ndarray:
    """Select the masks that are neither specks nor background and that no better mask shows.

    Going from the best score to the worst, a mask is dropped where it overlaps one that was kept (non-maximum
    suppression by IoU), or lies mostly within it: a wheel detected besides its car moves with the car and would only
    cut a hole into it. A worse mask that surrounds better ones, such as that of a crowd, is not dropped.

    Parameters
    ----------
    masks : bool (n, y, x)
    scores : floating (n,)
        Of equal scores, the first is better.
    params : InstanceParams

    Returns
    -------
    kept : intp (m,)
        Indices, best score first.

    Raises
    ------
    InputError
        There is not one score for each mask.
    """
    if np.shape(scores) != masks.shape[:1]:
        raise InputError("not one score for each mask", got=np.shape(scores), expected=masks.shape[:1])
    frame = masks.shape[1] * masks.shape[2]
    flat = masks.reshape(len(masks), frame)
    areas = np.count_nonzero(flat, axis=1)
    is_object = (areas > 0) & (areas >= params.min_area * frame) & (areas <= params.max_area * frame)
    kept: list[int] = []
    for index in np.argsort(-np.asarray(scores), kind="stable"):
        if len(kept) == params.max_objects:
            break
        if is_object[index] and not _is_shown(flat, areas, index, kept, params):
            kept.append(index)
    return np.array(kept, np.intp)


def _is_shown(flat: np.ndarray, areas: np.ndarray, index: int, kept: list[int], params: InstanceParams) -> bool:
    """Check whether a mask is the same as one of those kept, or a part of it."""
    shared = np.array([np.count_nonzero(flat[index] & flat[better]) for better in kept])
    union = areas[index] + areas[kept] - shared
    return bool((shared > params.nms_iou * union).any() or (shared > params.containment * areas[index]).any())
