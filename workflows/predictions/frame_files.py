"""Masks saved as one file per frame: which file belongs to which frame, and the labels in it."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources.files import natural_key
from moseg.workflows.sources.frame_matching import match_names


class FrameList(NamedTuple):
    """The frames that predictions are matched to: those of a sequence, annotated or not.

    Attributes
    ----------
    num_frames : int
    stems : tuple of str or None
        Names of the frames without suffix; None if they have none.
    """

    num_frames: int
    stems: tuple[str, ...] | None = None

    def name(self, index: int) -> str:
        """Return the name of a frame in messages: its stem, or its number from 0."""
        return self.stems[index] if self.stems else str(index)


class FrameFiles:
    """The masks of one sequence in one file per frame, each matched to its frame by `match_names`.

    Parameters
    ----------
    folders : sequence of Path
        Folders in which the sequence may lie; the first that holds files is used. Hidden files are ignored.
    pattern : str
        Pattern of the files' names. The part at the asterisk is compared with the frames' names.
    frames : FrameList
        Frames of the sequence.
    shape : (int, int)
        Height and width that each frame must have, px.
    read : callable
        Returns the values (y, x) of the file at a path.
    by_pairs : bool
        True for a method that uses a frame and the next one, so that the last frame may have no file. The file of the
        frame before is then used.

    Attributes
    ----------
    matching : Matching
        How the files were matched.
    repeats_last : bool
        True if the last frame has no file and that of the frame before is used.

    Raises
    ------
    MissingInputError
        No folder holds files.
    InputError
        The frame of a file cannot be determined from its name.
    """

    def __init__(
        self,
        folders: Sequence[Path],
        pattern: str,
        frames: FrameList,
        shape: tuple[int, int],
        read: Callable[[Path], np.ndarray],
        by_pairs: bool = False,
    ):
        self._frames, self._shape, self._read = frames, shape, read
        for self.folder in folders:
            found = (path for path in self.folder.glob(pattern) if not path.name.startswith("."))
            paths = sorted(found, key=lambda path: natural_key(path.name))
            if paths:
                break
        else:
            expected = " or ".join(str(folder / pattern) for folder in folders)
            raise MissingInputError("no predictions of the sequence", expected=expected)
        before, after = map(len, pattern.split("*"))
        names = [path.name[before : len(path.name) - after] for path in paths]
        self.matching, indices = match_names(names, frames.stems, frames.num_frames, self.folder, by_pairs)
        self._paths = dict(zip(indices, paths, strict=True))
        last = frames.num_frames - 1
        self.repeats_last = by_pairs and sorted(self._paths) == list(range(last))
        if self.repeats_last:
            self._paths[last] = self._paths[last - 1]

    def frame(self, index: int) -> np.ndarray:
        """Return the labels of frame `index`, uint16 (y, x); raise MissingInputError if it has no file."""
        if index not in self._paths:
            raise MissingInputError(
                f"no prediction of frame {self._frames.name(index)}",
                where=self.folder,
                got=f"{len(self._paths)} files for {self._frames.num_frames} frames",
                expected="one for every frame with ground truth",
            )
        path = self._paths[index]
        return as_labels(self._read(path), self._shape, path)


def as_labels(values: np.ndarray, shape: tuple[int, int], where: object) -> np.ndarray:
    """Return values read from a file as uint16 (y, x), in a new array.

    Parameters
    ----------
    values : bool, integer or float (y, x)
        Floats must be whole numbers: interpolated labels are not labels.
    shape : (int, int)
        Height and width that the frame must have, px.
    where : object
        File, for the error.

    Raises
    ------
    InputError
        The size differs, or the values are not labels 0..65535.
    """
    if values.shape != shape:
        raise InputError("wrong size of masks", where=where, got=values.shape, expected=shape)
    if values.dtype.kind not in "biuf":
        raise InputError("masks that are no labels", where=where, got=values.dtype, expected="integers 0..65535")
    with np.errstate(invalid="ignore"):
        labels = values.astype(np.uint16)
    if values.dtype.kind != "b" and not np.array_equal(labels, values):
        bad = values[labels != values].flat[0]
        raise InputError("masks that are no labels", where=where, got=bad, expected="integers 0..65535")
    return labels
