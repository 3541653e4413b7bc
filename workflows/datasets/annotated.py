"""A sequence of image files with annotations, wherever the two folders lie."""

import os
from typing import TYPE_CHECKING

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import SequenceSource

if TYPE_CHECKING:
    from moseg.workflows.sources import MaskKind


def annotated_sequence(
    name: str, frames_folder: str, masks_folder: str, kind: "MaskKind", void: int | None, max_side: int
) -> SequenceSource:
    """A sequence of a benchmark.

    Raises
    ------
    MissingInputError
        No annotations: a benchmark means nothing without.
    InputError
        Binary masks, 0 and 255, where 255 would be void: nothing would be left to score.
    """
    if not os.path.isdir(masks_folder):
        raise MissingInputError(f"sequence {name} has no annotations", expected=masks_folder)
    frames = sources.open_frames(frames_folder, max_side)
    annotations = sources.open_masks(masks_folder, frames, kind)
    if void is not None and sources.find_mask_kind(tuple(path for _, path in annotations.items)) == "binary":
        expected = "a label for each object"
        raise InputError("masks without object ids", where=masks_folder, got="only 0 and 255", expected=expected)
    return SequenceSource(name, frames, annotations, void)
