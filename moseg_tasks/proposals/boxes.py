"""Boxes of labelled objects in every frame."""

import numpy as np
from scipy import ndimage


def object_boxes(masks: np.ndarray, num_objects: int) -> np.ndarray:
    """Return the box of each object in each frame.

    Parameters
    ----------
    masks : uint16 (T, H, W)
        Object of each pixel, 1..num_objects; 0 = background.
    num_objects : int

    Returns
    -------
    boxes : int32 (num_objects, T, 4)
        x0, y0, x1, y1 px, the last column and row excluded; -1 where the object is absent.
    """
    boxes = np.full((num_objects, len(masks), 4), -1, np.int32)
    for t, mask in enumerate(masks):
        for index, found in enumerate(ndimage.find_objects(mask.astype(np.int32), num_objects)):
            if found is not None:
                rows, columns = found
                boxes[index, t] = columns.start, rows.start, columns.stop, rows.stop
    return boxes
