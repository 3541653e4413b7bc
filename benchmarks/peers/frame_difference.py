"""Difference of three frames, registered by homographies."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from frame_size import blurred, cleaned, reduced
from registration import Registration, warp

GAP = 3
"""Frames between those compared."""
MIN_DIFFERENCE = 12
"""Smallest threshold, grey levels: below it the difference is noise."""


def segment(frames: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the mask bool (y, x) of what differs from both the frame `GAP` before and the one `GAP` after.

    The difference is the largest of the three channels; the smaller of both times, so that the place that an object
    has left is not marked. Otsu's method sets the threshold of each frame.
    """
    small = blurred(reduced(frames))
    height, width = small[0].shape[:2]
    registration = Registration(reduced(frames))
    for t, frame in enumerate(small):
        differences = []
        for other in (t - GAP, t + GAP):
            if 0 <= other < len(small):
                there, covered = warp(small[other], registration.between(other, t), height, width)
                difference = cv2.absdiff(frame, there).max(axis=2)
                differences.append(np.where(covered, difference, 0).astype(np.uint8))
        if not differences:
            yield np.zeros(frames[0].shape[:2], bool)
            continue
        difference = np.minimum.reduce(differences)
        threshold, _ = cv2.threshold(difference, 0, 255, cv2.THRESH_OTSU)
        yield cleaned(difference > max(threshold, MIN_DIFFERENCE), frames[0].shape[:2])
