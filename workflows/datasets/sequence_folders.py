"""Folders of sequences, and where the frames lie in each."""

import os

from moseg.workflows.sources.files import IMAGE_SUFFIXES, natural_key, unreadable


def list_sequences(root: str, subfolders: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the folders below `root` in which `find_frames` finds frames, in natural order, none hidden."""
    try:
        names = sorted((name for name in os.listdir(root) if not name.startswith(".")), key=natural_key)
    except OSError as error:
        raise unreadable(root, error) from error
    return tuple(name for name in names if find_frames(os.path.join(root, name), subfolders))


def find_frames(sequence_folder: str, subfolders: tuple[str, ...]) -> str | None:
    """The first of the subfolders that holds images; None where none does."""
    for subfolder in subfolders:
        folder = os.path.join(sequence_folder, subfolder)
        if holds_images(folder):
            return folder
    return None


def holds_images(folder: str) -> bool:
    """True when `folder` is one and has an image in it; what is wrong with it is said when it is opened."""
    if not os.path.isdir(folder):
        return False
    try:
        with os.scandir(folder) as entries:
            names = (entry.name for entry in entries)
            return any(name.lower().endswith(IMAGE_SUFFIXES) and not name.startswith(".") for name in names)
    except OSError as error:
        raise unreadable(folder, error) from error
