"""Boxes as prompts of a segmentation network."""

import numpy as np

from moseg.schemas.errors import InputError


def as_boxes(boxes: np.ndarray) -> np.ndarray:
    """Return boxes as float32 (n, 4): left, top, right, bottom, px; raise InputError unless they are boxes."""
    boxes = np.asarray(boxes, np.float32)
    if boxes.ndim != 2 or boxes.shape[1] != 4 or not (boxes[:, :2] < boxes[:, 2:]).all():
        raise InputError("not boxes", got=f"shape {boxes.shape}", expected="(n, 4): left < right and top < bottom, px")
    return boxes
