"""Half-precision maps and single-precision arithmetic.

Maps are stored in half precision and computed in single. NumPy converts one number at a time; OpenCV gives the same
values some eight times faster.
"""

import cv2
import numpy as np


def widen(half: np.ndarray) -> np.ndarray:
    """`half` float16 of any shape as float32."""
    return cv2.add(half.reshape(-1, 1), 0.0, dtype=cv2.CV_32F).reshape(half.shape)


def narrow(single: np.ndarray) -> np.ndarray:
    """`single` float32 of any shape as float16, rounded to the nearest."""
    return cv2.add(np.asarray(single, np.float32).reshape(-1, 1), 0.0, dtype=cv2.CV_16F).reshape(single.shape)
