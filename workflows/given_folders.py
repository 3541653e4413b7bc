"""Cues that the user gives as folders: masks as object proposals, maps of inverse depth."""

import os

from schemas.errors import MissingInputError
from workflows.datasets import SequenceSource
from workflows.sources import open_depth, open_masks


def with_given_folders(source: SequenceSource, folders: dict[str, str], max_side: int) -> SequenceSource:
    """The sequence with its `proposals` and `depth` read from folders.

    A folder is looked for under the sequence's name below the path given; where there is none the path itself is taken.
    """
    if "proposals" in folders:
        path = _folder_of(source, "proposals", folders["proposals"])
        masks = open_masks(path, source.frames)
        # Beside other ids 255 is what DAVIS and YouTube-VOS call void; alone it is an object.
        source = source._replace(objects=masks, objects_void=255 if masks.kind == "instance" else None)
    if "depth" in folders:
        path = _folder_of(source, "depth", folders["depth"])
        depth = open_depth(path, source.frames, source.frames.num_frames(), max_side)
        source = source._replace(depth=depth)
    return source


def _folder_of(source: SequenceSource, cue: str, path: str) -> str:
    below = os.path.join(path, source.name)
    if os.path.isdir(below):
        return below
    if not os.path.isdir(path):
        raise MissingInputError("no such folder", where=f"--{cue} folder:{path}")
    return path
