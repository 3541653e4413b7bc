"""Layout of a folder a sequence, with frames in one subfolder and masks in another."""

import os

from schemas.errors import MissingInputError
from workflows.datasets.annotated import holds_images
from workflows.sources.files import natural_key


def find_frames(sequence_folder: str, subfolders: tuple[str, ...]) -> str | None:
    """The first of the subfolders that holds images; None where none does."""
    for subfolder in subfolders:
        folder = os.path.join(sequence_folder, subfolder)
        if holds_images(folder):
            return folder
    return None


def list_sequences(root: str, subfolders: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the folders below `root` in which `find_frames` finds frames, in natural order."""
    if not os.path.isdir(root):
        raise MissingInputError("folder does not exist", where=root)
    names = sorted(os.listdir(root), key=natural_key)
    return tuple(name for name in names if find_frames(os.path.join(root, name), subfolders))
