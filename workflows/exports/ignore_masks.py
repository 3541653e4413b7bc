"""Masks of what a reconstruction of the static scene must not use: the moving objects, a little widened."""

from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation
from moseg.workflows.process.atomic_write import atomic_path, blame_output

DEFAULT_DILATION = 5
"""Px. Features are found on the borders of moving objects, and masks are a few pixels off there."""


class Polarity(NamedTuple):
    """Values of the pixels to ignore and of those to use."""

    ignored: int
    used: int


BLACK_IS_IGNORED = Polarity(0, 255)


def write_ignore_masks(target: OwnedFolder, saved: SavedSegmentation, polarity: Polarity, dilation: int) -> Path:
    """Write one 8-bit grey PNG per frame under the names of the folder.

    Parameters
    ----------
    target : OwnedFolder
        With a name a frame.
    saved : SavedSegmentation
    polarity : Polarity
    dilation : int
        Px by which what moves is widened.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    InputError
        A mask cannot be read, or the folder not be written.
    """
    folder = target.folder
    with target:
        for name, labels in zip(target.names, saved.labels(), strict=True):
            moves = dilate_moving(labels, dilation)
            image = Image.fromarray(np.where(moves, polarity.ignored, polarity.used).astype(np.uint8))
            with atomic_path(folder / name) as temporary, blame_output(folder / name):
                image.save(temporary, format="PNG")
    return folder


def dilate_moving(labels: np.ndarray, dilation: int) -> np.ndarray:
    """Pixels within `dilation` px of a moving one, bool (y, x); uint16 (y, x) labels, 0 = static."""
    if dilation < 0:
        raise InputError("impossible dilation", got=dilation, expected="0 px or more")
    moves = labels > 0
    if not dilation or not moves.any():
        return moves
    return cv2.distanceTransform((~moves).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) <= dilation
