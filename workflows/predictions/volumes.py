"""Volumes of labels (frame, y, x) in .npy and .npz files, read a frame at a time and never unpickled."""

import zipfile
import zlib
from pathlib import Path

import numpy as np
from numpy.lib import format as npy_format

from schemas.errors import InputError, MissingInputError
from workflows.predictions.as_labels import as_labels

_MOSEG_KEY = "segmentation"


class Volume:
    """A volume of labels in an open file."""

    def __init__(self, path: Path, frames: "np.ndarray | CompressedFrames"):
        self.path = path
        self.frames = frames

    def frame(self, index: int) -> np.ndarray:
        """Labels of one frame, uint16 (y, x)."""
        return as_labels(self.frames[index], self.frames.shape[1:], self.path)


def open_volume(folder: Path, name: str, num_frames: int, shape: tuple[int, int]) -> Volume:
    """The volume ``<sequence>.npz`` or ``<sequence>.npy``, with one entry per frame of the sequence.

    Of an archive the array ``segmentation`` is taken (MoSeg), or its only one.
    """
    paths = [folder / f"{name}.npz", folder / f"{name}.npy"]
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        raise MissingInputError("no predictions of the sequence", expected=" or ".join(map(str, paths)))
    try:
        if path.suffix == ".npy":
            frames = npy_format.open_memmap(path, mode="r")
        else:
            frames = CompressedFrames(path)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise _unreadable(path, error) from error
    if frames.shape != (num_frames, *shape):
        raise InputError("wrong size of masks", where=path, got=frames.shape, expected=(num_frames, *shape))
    return Volume(path, frames)


class CompressedFrames:
    """The frames of a volume in an archive, decompressed one after the other.

    A frame before the last one read starts again at the beginning.
    """

    def __init__(self, path: Path):
        self.path = path
        self._archive = zipfile.ZipFile(path)
        self._member = _volume_member(self._archive.namelist())
        self._rewind()

    def __getitem__(self, index: int) -> np.ndarray:
        if index < self._next:
            self._rewind()
        nbytes = self.dtype.itemsize * self.shape[1] * self.shape[2]
        while self._next <= index:
            try:
                data = self._stream.read(nbytes)
            except (OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
                raise _unreadable(self.path, error) from error
            if len(data) != nbytes:
                raise InputError("cut-off archive", where=self.path, got=f"{self._next} frames", expected=self.shape[0])
            self._next += 1
        return np.frombuffer(data, dtype=self.dtype).reshape(self.shape[1:])

    def _rewind(self) -> None:
        self._stream = self._archive.open(self._member)
        self._next = 0
        version = npy_format.read_magic(self._stream)
        read_header = npy_format.read_array_header_1_0 if version == (1, 0) else npy_format.read_array_header_2_0
        self.shape, is_fortran, self.dtype = read_header(self._stream)
        if self.dtype.hasobject:
            raise ValueError("pickled objects")
        if is_fortran:
            raise ValueError("frames that are not contiguous (Fortran order)")


def _volume_member(names: list[str]) -> str:
    """Name of the archive's member that holds the volume; ValueError where it cannot be told."""
    if f"{_MOSEG_KEY}.npy" in names:
        return f"{_MOSEG_KEY}.npy"
    if len(names) != 1:
        raise ValueError(f"arrays {', '.join(sorted(names))} and none named {_MOSEG_KEY}")
    return names[0]


def _unreadable(path: Path, error: Exception) -> InputError:
    return InputError("unreadable volume", where=path, got=error, expected="an array (frame, y, x) of integers")
