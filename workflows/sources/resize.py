"""The size at which frames are analysed, and images and labels at another size."""

import cv2
import numpy as np


def working_size(size: tuple[int, int], max_side: int) -> tuple[int, int]:
    """(height, width) px of frames of `size` once their longer side is at most `max_side`."""
    longer = max(size)
    if longer <= max_side:
        return size
    return max(1, round(size[0] * max_side / longer)), max(1, round(size[1] * max_side / longer))


def shrink_to(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The image area-averaged to (height, width) `size`; itself where that is its size."""
    if image.shape[:2] == size:
        return image
    return cv2.resize(image, (size[1], size[0]), interpolation=cv2.INTER_AREA)


def resize_labels(labels: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """uint16 (y, x) labels at `shape` (height, width); unchanged where that is their size.

    The nearest pixel counts, so that no label is invented.
    """
    if labels.shape == tuple(shape):
        return labels
    height, width = shape
    return cv2.resize(labels, (width, height), interpolation=cv2.INTER_NEAREST_EXACT)
