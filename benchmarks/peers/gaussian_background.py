"""Mixtures of Gaussians of the background (OpenCV's MOG2) on registered frames.

Frames are drawn on a canvas larger than a frame, at the place where the accumulated registration maps them, and each
pixel of the canvas has a mixture. When a frame would leave the canvas, or its scale has changed too much, a new canvas
begins with that frame. Frames near those of a canvas help to learn its mixtures. The clip is on disk, so that every
mixture is learned from all frames of its canvas before any is classified: what is classified while it is learned marks
every pixel that comes into view.

References
----------
Zivkovic, "Improved adaptive Gaussian mixture model for background subtraction", ICPR 2004.
"""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from frame_size import blurred, cleaned, reduced
from registration import Registration, warp

MARGIN = 0.5
"""Margin of the canvas on every side, as a share of the frame's side."""
MIN_AREA, MAX_AREA = 0.6, 1.7
"""Range of a frame's area on its canvas, as a share of its own."""
NUM_NEIGHBOURS = 20
"""Frames before and after those of a canvas from which it is learned too."""
MIN_SEEN = 5
"""Frames that must have shown a pixel of the canvas before it can be classified."""
VAR_THRESHOLD = 25
"""Squared distance to a Gaussian in its variances, from which a colour is not explained by it."""


def segment(frames: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the mask bool (y, x) of the pixels that no Gaussian of the background explains."""
    small = reduced(frames)
    registration, small = Registration(small), blurred(small)
    start = 0
    while start < len(small):
        canvas = Canvas(small, registration, start)
        for t in range(start, canvas.end):
            yield cleaned(canvas.foreground(t), frames[0].shape[:2])
        start = canvas.end


class Canvas:
    """Mixtures of Gaussians of the background that a stretch of frames shows.

    Parameters
    ----------
    frames : sequence of uint8 (y, x, 3)
    registration : Registration
    start : int
        First frame of the stretch, which lies in the middle of the canvas.

    Attributes
    ----------
    end : int
        Frame after the last one of the stretch.
    """

    def __init__(self, frames: Sequence[np.ndarray], registration: Registration, start: int):
        self._frames, self._registration, self._start = frames, registration, start
        height, width = frames[0].shape[:2]
        top, left = int(MARGIN * height), int(MARGIN * width)
        self._height, self._width = height + 2 * top, width + 2 * left
        self._to_canvas = np.array([[1, 0, left], [0, 1, top], [0, 0, 1]], float)
        self.end = start + 1
        while self.end < len(frames) and self._holds(self.end):
            self.end += 1
        self._mixtures = cv2.createBackgroundSubtractorMOG2(len(frames), VAR_THRESHOLD, detectShadows=False)
        self._picture = np.zeros((self._height, self._width, 3), np.uint8)
        self._num_seen = np.zeros((self._height, self._width), np.int32)
        self._learn()

    def foreground(self, t: int) -> np.ndarray:
        """Return the mask bool (y, x) of one frame's pixels that the background does not explain."""
        self._draw(t)
        found = (self._mixtures.apply(self._picture, learningRate=0) > 0) & (self._num_seen >= MIN_SEEN)
        height, width = self._frames[t].shape[:2]
        back, _ = warp(found.astype(np.uint8) * 255, np.linalg.inv(self._place(t)), height, width)
        return back > 127

    def _learn(self) -> None:
        """Learn the mixtures from the frames of the stretch and near it, each with the same weight."""
        first, last = max(0, self._start - NUM_NEIGHBOURS), min(len(self._frames), self.end + NUM_NEIGHBOURS)
        for number, t in enumerate(range(first, last), start=1):
            self._num_seen += self._draw(t)
            self._mixtures.apply(self._picture, learningRate=1 / number)

    def _draw(self, t: int) -> np.ndarray:
        """Draw a frame on the picture of the canvas, which keeps what it shows elsewhere, and return where."""
        image, covered = warp(self._frames[t], self._place(t), self._height, self._width)
        self._picture[covered] = image[covered]
        return covered

    def _place(self, t: int) -> np.ndarray:
        """Return the homography from a frame to the canvas."""
        return self._to_canvas @ self._registration.between(t, self._start)

    def _holds(self, t: int) -> bool:
        """Return whether a frame lies inside the canvas, at a similar scale."""
        height, width = self._frames[t].shape[:2]
        corners = np.array([[[0, 0]], [[width, 0]], [[width, height]], [[0, height]]], float)
        x, y = cv2.perspectiveTransform(corners, self._place(t))[:, 0].T
        area = cv2.contourArea(np.stack([x, y], axis=1).astype(np.float32)) / (height * width)
        return bool(
            x.min() >= 0
            and y.min() >= 0
            and x.max() <= self._width
            and y.max() <= self._height
            and MIN_AREA < area < MAX_AREA
        )
