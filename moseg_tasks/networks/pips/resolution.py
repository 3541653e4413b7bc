"""The size of the network's input, and points at the frame's and at the network's size."""

from typing import NamedTuple

import cv2
import numpy as np

MULTIPLE = 8
"""Sides of the network's input are multiples of this, as in its published evaluation (360 x 640), px."""


class Resolution(NamedTuple):
    """A frame's size and that of the network's input, (height, width), px.

    Pixel centres lie at integers in both, and both show the same edges, which lie half a pixel outside the outermost
    centres: x_network + 1/2 = (x_frame + 1/2) width_network / width_frame, and likewise y. Each axis has its
    own scale, because sides are rounded; both are inverted exactly.
    """

    frame: tuple[int, int]
    network: tuple[int, int]

    @classmethod
    def capped(cls, frame: tuple[int, int], max_side: int, min_side: int) -> "Resolution":
        """Return the resolution with the longer side at most about `max_side` and all sides at least `min_side`."""
        scale = min(1.0, max_side / max(frame))
        height, width = (max(min_side, MULTIPLE * round(side * scale / MULTIPLE)) for side in frame)
        return cls(frame, (height, width))

    def resize(self, image: np.ndarray) -> np.ndarray:
        """Resize a frame uint8 (y, x, 3) bilinearly, as published, to the network's size: float32 in [0, 255]."""
        height, width = self.network
        return cv2.resize(image.astype(np.float32), (width, height), interpolation=cv2.INTER_LINEAR)

    def to_network(self, points: np.ndarray) -> np.ndarray:
        """Convert points (..., 2), xy px of the frame, to px of the network's image; float64."""
        return (points + 0.5) * self._scale() - 0.5

    def to_frame(self, points: np.ndarray) -> np.ndarray:
        """Convert points (..., 2), xy px of the network's image, to px of the frame; float64."""
        return (points + 0.5) / self._scale() - 0.5

    def _scale(self) -> np.ndarray:
        return np.array(self.network[::-1]) / np.array(self.frame[::-1])
