"""The size at which frames are analysed, and resizing of images and labels."""

import cv2
import numpy as np


def working_size(size: tuple[int, int], max_side: int) -> tuple[int, int]:
    """Return (height, width) of frames of `size` after reduction of their longer side to `max_side`, px."""
    longer = max(size)
    if longer <= max_side:
        return size
    return max(1, round(size[0] * max_side / longer)), max(1, round(size[1] * max_side / longer))


def shrink_to(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return the image area-averaged to (height, width) `size`; the image itself if it has that size."""
    if image.shape[:2] == size:
        return image
    return cv2.resize(image, (size[1], size[0]), interpolation=cv2.INTER_AREA)


def resize_labels(labels: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return uint16 (y, x) labels at `shape` (height, width); the labels themselves if they have that size.

    Each pixel takes the nearest label, so that no label is new.
    """
    if labels.shape == tuple(shape):
        return labels
    height, width = shape
    return cv2.resize(labels, (width, height), interpolation=cv2.INTER_NEAREST_EXACT)
