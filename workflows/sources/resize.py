"""Labels at another size: nearest neighbour, so that no label is invented."""

import cv2
import numpy as np


def resize_labels(labels: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """uint16 (y, x) labels at `shape` (height, width); unchanged where that is their size."""
    if labels.shape == tuple(shape):
        return labels
    height, width = shape
    return cv2.resize(labels, (width, height), interpolation=cv2.INTER_NEAREST_EXACT)
