"""The user's own sequences."""

import os
from dataclasses import dataclass

from moseg.schemas.errors import MissingInputError
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import SequenceSource
from moseg.workflows.datasets.sequence_folders import find_frames, holds_images, list_sequences

FRAME_FOLDERS = ("frames",)


@dataclass(frozen=True)
class FolderOfSequences:
    """``<root>/<sequence>/frames`` with optional ``<root>/<sequence>/masks``, matched by stem.

    A root that itself holds ``frames``, or images, is a single sequence with the name of its folder. Masks that hold
    only 0 and 255 are binary; in others values are instances and 255 is void.
    """

    name: str = "folder"
    needs_root: bool = True
    official: None = None
    list_name: None = None
    ground_truth: str = "instance or binary masks, if there are any"
    tree: str = "<sequence>/frames/* and, for scores, <sequence>/masks/*.png; or the frames of a single sequence"
    source: str = "your own frames"

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Return the sequences, or the single one at the root."""
        if _single_frames(root):
            return (_folder_name(root),)
        names = list_sequences(root, FRAME_FOLDERS)
        if not names:
            raise MissingInputError("no sequence", where=root, expected=self.tree)
        return names

    def open_sequence(self, root: str, name: str, max_side: int) -> SequenceSource:
        """Return the sources of one sequence; without masks it can be segmented but not scored."""
        single = _single_frames(root)
        folder = root if single else os.path.join(root, name)
        frames = sources.open_frames(single or find_frames(folder, FRAME_FOLDERS), max_side)
        masks = os.path.join(folder, "masks")
        if not os.path.isdir(masks):
            return SequenceSource(name, frames)
        annotations = sources.open_masks(masks, frames)
        return SequenceSource(name, frames, annotations, 255 if annotations.kind == "instance" else None)


def _single_frames(root: str) -> str | None:
    """Return the folder of the frames if the root is a single sequence, else None."""
    return find_frames(root, FRAME_FOLDERS) or (root if holds_images(root) else None)


def _folder_name(root: str) -> str:
    return os.path.basename(os.path.normpath(root))


FOLDER = FolderOfSequences()
