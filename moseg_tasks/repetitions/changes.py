"""Changes from picture to picture, and those among them that are much smaller than the changes beside them."""

from collections.abc import Sequence

import cv2
import numpy as np

from moseg.schemas.parameters import RepetitionParams


def mean_change(image0: np.ndarray, image1: np.ndarray, step: int) -> float:
    """Return the mean absolute difference of two frames, uint8 (y, x, 3), on every `step`-th row, grey levels."""
    return float(np.mean(cv2.absdiff(image0[::step], image1[::step])))


def find_repetitions(changes: Sequence[float], params: RepetitionParams) -> list[int]:
    """Find the changes that only coding again makes, which are those of a repetition.

    Coding a frame again after itself changes it a little, but much less than the frames around it change: the largest
    change among `params.window` before it and that among as many after it are both much larger, and at least
    `params.min_change`, because a video in which nothing moves changes unevenly too. So nothing repeats where a camera
    stops. Where the video begins or ends within the window, only
    the other side is read, and if it does on both sides, all changes are.

    Parameters
    ----------
    changes : sequence of float
        Between the frames of a video, or of a part of it that reaches a window farther than what is read of the result.
    params : RepetitionParams

    Returns
    -------
    repetitions : list of int
        Indices of these changes.
    """
    found, length = [], params.window
    for index, change in enumerate(changes):
        sides = (changes[max(index - length, 0) : index], changes[index + 1 : index + 1 + length])
        whole = [side for side in sides if len(side) == length] or [changes]
        usual = min(map(max, whole))
        if usual >= params.min_change and change < params.max_change * usual:
            found.append(index)
    return found
