"""RigidMask's output: ``pm-<frame>.pfm``, a float label per pixel."""

from pathlib import Path

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.predictions.as_labels import as_labels
from moseg.workflows.predictions.frame_files import FrameFiles
from moseg.workflows.predictions.frame_list import FrameList


class RigidMaskLabels:
    """The foreground of one sequence, as one object.

    RigidMask numbers the rigid bodies of each frame anew, so its labels say nothing about identity over time. Any link
    between frames would be ours and not the method's: what moves is taken together as object 1.
    """

    def __init__(self, files: FrameFiles, shape: tuple[int, int]):
        self.files = files
        self.matching, self.repeats_last = files.matching, files.repeats_last
        self.shape = shape

    def frame(self, index: int) -> np.ndarray:
        """1 where a rigid body moves, uint16 (y, x)."""
        path = self.files.path(index)
        return as_labels(read_pfm(path) > 0, self.shape, path)


def open_rigidmask(folder: Path, name: str, frames: FrameList, shape: tuple[int, int]) -> RigidMaskLabels:
    """``<sequence>/pm-*.pfm`` or ``seq-<sequence>/pm-*.pfm``; an absent last frame repeats the one before."""
    folders = [folder / name, folder / f"seq-{name}"]
    return RigidMaskLabels(FrameFiles(folders, "pm-*.pfm", frames, by_pairs=True), shape)


def read_pfm(path: Path) -> np.ndarray:
    """A grey portable float map, float32 (y, x), top row first.

    The file has three lines of text, ``Pf``, width and height, and a scale whose sign is the byte order (negative is
    little-endian); then the rows from the bottom up.

    Raises
    ------
    InputError
        Where it is no grey float map or is cut off.
    """
    with path.open("rb") as file:
        kind, size, scale = (file.readline(64).strip() for _ in range(3))
        data = file.read()
    try:
        width, height = map(int, size.split())
        order = "<" if float(scale) < 0 else ">"
    except ValueError as error:
        raise InputError("no portable float map", where=path, got=size + b" " + scale) from error
    if kind != b"Pf" or min(width, height) < 1:
        raise InputError("no grey portable float map", where=path, got=kind.decode("latin-1"), expected="Pf")
    if len(data) != 4 * width * height:
        raise InputError("cut-off float map", where=path, got=f"{len(data)} bytes", expected=4 * width * height)
    return np.frombuffer(data, dtype=f"{order}f4").reshape(height, width)[::-1].astype(np.float32)
