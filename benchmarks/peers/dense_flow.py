"""Dense flow of each frame of a clip (DIS)."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np


def flow_of_each(frames: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the flow float32 (y, x, 2) of each frame to the next one, of the last frame to the one before it, px."""
    search = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    gray = [cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY) for frame in frames]
    for t, image in enumerate(gray):
        other = gray[t + 1] if t + 1 < len(gray) else gray[t - 1]
        yield search.calc(image, other, None)
