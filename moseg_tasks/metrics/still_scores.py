"""Score of a sequence in which nothing moves: every pixel that is labelled as moving is wrong."""

from collections.abc import Iterable

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.scores import StillScore


def score_still(frames: Iterable[np.ndarray]) -> StillScore:
    """Score the labels of all frames of a sequence in which nothing moves.

    Parameters
    ----------
    frames : iterable of unsigned integer (y, x)
        Labels of each frame; 0 is static, every other label moves.

    Returns
    -------
    StillScore
        Percent of the pixels of all frames that are labelled as moving, and of the frames with such a pixel.

    Raises
    ------
    InputError
        If there is no frame or one is not a label image.
    """
    num_pixels = num_frames = false_pixels = false_frames = 0
    for labels in frames:
        if labels.ndim != 2 or labels.dtype not in (np.uint8, np.uint16):
            got = f"{labels.dtype} {labels.shape}"
            raise InputError(
                "not a label image", where=f"frame {num_frames}", got=got, expected="uint8 or uint16 (y, x)"
            )
        wrong = np.count_nonzero(labels)
        num_pixels += labels.size
        num_frames += 1
        false_pixels += wrong
        false_frames += wrong > 0
    if not num_pixels:
        raise InputError("no frame to score", got=num_frames, expected="at least 1")
    return StillScore(false_pixels=100 * false_pixels / num_pixels, false_frames=100 * false_frames / num_frames)
