"""Volumes of labels (frame, y, x) in .npy and .npz files, read one frame at a time and never unpickled."""

import os
import zipfile
from pathlib import Path

import numpy as np

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.predictions.frame_files import FrameList, as_labels
from moseg.workflows.sources.files import unreadable
from moseg.workflows.sources.frame_matching import Matching
from moseg.workflows.sources.numpy_file import ARCHIVE_ERRORS, HEADER_BYTES, read_header, undecodable

_KEYS = ("segmentation", "labels")
"""Names of the array in an archive of MoSeg's authors, and in one of `moseg export`."""
_WHAT = "volume of labels"


class Volume:
    """A volume of labels in an open file; its entries are the frames in order, without names."""

    matching = Matching.ORDER
    repeats_last = False

    def __init__(self, path: Path, frames: "np.ndarray | CompressedFrames"):
        self.path = path
        self.frames = frames

    def frame(self, index: int) -> np.ndarray:
        """Return the labels of one frame, uint16 (y, x)."""
        return as_labels(self.frames[index], self.frames.shape[1:], self.path)


def open_volume(folder: Path, name: str, frames: FrameList, shape: tuple[int, int]) -> Volume:
    """Open the volume ``<sequence>.npz`` or ``<sequence>.npy``, with one entry per frame of the sequence.

    From an archive, the array ``segmentation`` (MoSeg) is read, or ``labels`` (`moseg export`), or its only array.
    """
    paths = [folder / f"{name}.npz", folder / f"{name}.npy"]
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        raise MissingInputError("no predictions of the sequence", expected=" or ".join(map(str, paths)))
    volume = _map_frames(path) if path.suffix == ".npy" else CompressedFrames(path)
    if volume.dtype.kind not in "biuf":
        raise InputError("masks that are no labels", where=path, got=volume.dtype, expected="integers 0..65535")
    expected = (frames.num_frames, *shape)
    if volume.shape != expected:
        raise InputError("wrong size of masks", where=path, got=volume.shape, expected=expected)
    return Volume(path, volume)


class CompressedFrames:
    """The frames of a volume in an archive, decompressed one after the other.

    Reading a frame before the last one read starts again at the beginning.
    """

    def __init__(self, path: Path):
        self.path = path
        try:
            self._archive = zipfile.ZipFile(path)
        except ARCHIVE_ERRORS as error:
            raise undecodable(path, _WHAT, error) from error
        self._member = _volume_member(self._archive.namelist(), path)
        self._rewind()

    def __getitem__(self, index: int) -> np.ndarray:
        if index < self._next:
            self._rewind()
        nbytes = self.dtype.itemsize * self.shape[1] * self.shape[2]
        while self._next <= index:
            try:
                data = self._stream.read(nbytes)
            except ARCHIVE_ERRORS as error:
                raise undecodable(self.path, _WHAT, error) from error
            if len(data) != nbytes:
                raise InputError("cut-off archive", where=self.path, got=f"{self._next} frames", expected=self.shape[0])
            self._next += 1
        return np.frombuffer(data, dtype=self.dtype).reshape(self.shape[1:])

    def _rewind(self) -> None:
        self._next = 0
        try:
            self._stream = self._archive.open(self._member)
            header = read_header(self._stream.read(HEADER_BYTES), self.path, _WHAT)
            self._stream.seek(header.offset)
        except InputError:
            raise
        except ARCHIVE_ERRORS as error:
            raise undecodable(self.path, _WHAT, error) from error
        self.shape, self.dtype = header.shape, header.dtype
        if header.is_fortran:
            raise undecodable(self.path, _WHAT, "frames that are not contiguous (Fortran order)")


def _map_frames(path: Path) -> np.ndarray:
    """Map the array of a ``.npy`` file into memory."""
    try:
        with path.open("rb") as file:
            start = file.read(HEADER_BYTES)
            num_bytes = file.seek(0, os.SEEK_END)
    except OSError as error:
        raise unreadable(str(path), error) from error
    header = read_header(start, path, _WHAT)
    if header.end > num_bytes:
        got = f"{num_bytes} bytes for {header.dtype} of shape {header.shape}"
        raise undecodable(path, _WHAT, got, f"{header.end} bytes")
    try:
        order = "F" if header.is_fortran else "C"
        return np.memmap(path, header.dtype, "r", header.offset, header.shape, order)
    # Sides too large for any array, next to one of 0, and types without a size.
    except (OSError, ValueError, TypeError, OverflowError) as error:
        raise undecodable(path, _WHAT, error) from error


def _volume_member(names: list[str], path: Path) -> str:
    """Return the name of the archive's member that holds the volume; raise InputError if it is not clear."""
    for key in _KEYS:
        if f"{key}.npy" in names:
            return f"{key}.npy"
    if len(names) != 1:
        got = f"arrays {', '.join(sorted(names))} and none named {' or '.join(_KEYS)}"
        raise undecodable(path, _WHAT, got, "an array (frame, y, x) of integers")
    return names[0]
