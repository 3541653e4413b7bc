"""Objects of masks without identities."""

import numpy as np
from scipy import ndimage

MAX_PARTS = 100


def one_object(masks: np.ndarray) -> np.ndarray:
    """Return labels uint8 (frame, y, x) of masks bool: everything that moves is one object."""
    return masks.astype(np.uint8)


def connected_objects(masks: np.ndarray) -> np.ndarray:
    """Return labels uint8 (frame, y, x): an object is what is connected in space and over neighbouring frames.

    The largest `MAX_PARTS` have a label each; the rest share one.
    """
    parts, num_parts = ndimage.label(masks, structure=np.ones((3, 3, 3)))
    by_size = np.argsort(-np.bincount(parts.ravel(), minlength=num_parts + 1)[1:], kind="stable")
    label = np.zeros(num_parts + 1, np.uint8)
    label[1 + by_size] = np.minimum(np.arange(num_parts), MAX_PARTS) + 1
    return label[parts]


LABELLINGS = {"one": one_object, "connected": connected_objects}
