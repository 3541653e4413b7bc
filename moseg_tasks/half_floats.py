"""Conversion between half- and single-precision maps.

Maps are stored in half precision and computed in single precision. NumPy converts one number at a time; OpenCV gives
the same values about eight times faster.
"""

import cv2
import numpy as np


def to_float32(half: np.ndarray) -> np.ndarray:
    """Convert `half`, float16 of any shape, to float32."""
    # Contiguous: OpenCV would go through the values of a strided view one by one.
    return cv2.add(np.ascontiguousarray(half).reshape(-1, 1), 0.0, dtype=cv2.CV_32F).reshape(half.shape)


def to_float16(single: np.ndarray) -> np.ndarray:
    """Convert `single`, float32 of any shape, to float16, rounded to the nearest."""
    return cv2.add(np.asarray(single, np.float32).reshape(-1, 1), 0.0, dtype=cv2.CV_16F).reshape(single.shape)
