"""Size at which the peers that compare colours work, and cleaning of their masks."""

from collections.abc import Sequence

import cv2
import numpy as np

LONGER_SIDE = 427
"""Longer side to which larger frames are reduced, px, as on the working grid of `moseg`."""
BLUR = 1.0
"""Standard deviation of the blur that hides small errors of the registration, px."""
OPENING, CLOSING = 3, 21
"""Diameters of the discs, px: one removes grains, the other joins and fills what was found of an object."""


def reduced(frames: Sequence[np.ndarray], longer_side: int = LONGER_SIDE) -> list[np.ndarray]:
    """Return frames whose longer side is at most that, by area."""
    height, width = frames[0].shape[:2]
    scale = longer_side / max(height, width)
    if scale >= 1:
        return list(frames)
    size = (round(width * scale), round(height * scale))
    return [cv2.resize(frame, size, interpolation=cv2.INTER_AREA) for frame in frames]


def blurred(frames: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return blurred frames."""
    return [cv2.GaussianBlur(frame, (0, 0), BLUR) for frame in frames]


def cleaned(mask: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return a mask bool (y, x) opened, closed, and enlarged to a (height, width)."""
    discs = [cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side)) for side in (OPENING, CLOSING)]
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, discs[0])
    return enlarged(cv2.morphologyEx(opened, cv2.MORPH_CLOSE, discs[1]), size)


def enlarged(share: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return where a share 0..1 (y, x), enlarged to a (height, width), exceeds one half."""
    return cv2.resize(share.astype(np.float32), size[::-1], interpolation=cv2.INTER_LINEAR) > 0.5
