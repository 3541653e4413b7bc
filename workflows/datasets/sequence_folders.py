"""Folders of sequences: their frames, and sequences with annotations in another folder."""

import os
from typing import TYPE_CHECKING

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import SequenceSource
from moseg.workflows.sources.files import IMAGE_SUFFIXES, natural_key, unreadable

if TYPE_CHECKING:
    from moseg.workflows.sources import MaskKind


def list_sequences(root: str, subfolders: tuple[str, ...]) -> tuple[str, ...]:
    """Return the folders below `root` in which `find_frames` finds frames, by name in natural order, none hidden."""
    try:
        names = sorted((name for name in os.listdir(root) if not name.startswith(".")), key=natural_key)
    except OSError as error:
        raise unreadable(root, error) from error
    return tuple(name for name in names if find_frames(os.path.join(root, name), subfolders))


def find_frames(sequence_folder: str, subfolders: tuple[str, ...]) -> str | None:
    """Return the first of the subfolders that holds images; None if none does."""
    for subfolder in subfolders:
        folder = os.path.join(sequence_folder, subfolder)
        if holds_images(folder):
            return folder
    return None


def holds_images(folder: str) -> bool:
    """Return whether `folder` is a folder with an image; errors in it are reported when it is opened."""
    if not os.path.isdir(folder):
        return False
    try:
        with os.scandir(folder) as entries:
            names = (entry.name for entry in entries)
            return any(name.lower().endswith(IMAGE_SUFFIXES) and not name.startswith(".") for name in names)
    except OSError as error:
        raise unreadable(folder, error) from error


def annotated_sequence(
    name: str, frames_folder: str, masks_folder: str, kind: "MaskKind", void: int | None, max_side: int
) -> SequenceSource:
    """Open a sequence of a benchmark.

    Raises
    ------
    MissingInputError
        There are no annotations, which a benchmark needs.
    InputError
        Binary masks, 0 and 255, although 255 is void: nothing would be left to score.
    """
    if not os.path.isdir(masks_folder):
        raise MissingInputError(f"sequence {name} has no annotations", expected=masks_folder)
    frames = sources.open_frames(frames_folder, max_side)
    annotations = sources.open_masks(masks_folder, frames, kind)
    if void is not None and sources.find_mask_kind(tuple(path for _, path in annotations.items)) == "binary":
        expected = "a label for each object; or void=None, if 255 is what moves"
        raise InputError("masks without object ids", where=masks_folder, got="only 0 and 255", expected=expected)
    return SequenceSource(name, frames, annotations, void)
