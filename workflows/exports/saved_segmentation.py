"""Output of `moseg segment` in a folder: the masks of every frame and the summary of its motions."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path

import numpy as np

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary, check_file_name, read_motion
from moseg.workflows.exports.outputs import MASKS, MOTION, mask_name
from moseg.workflows.sources import VideoFile
from moseg.workflows.sources.files import IMAGE_SUFFIXES, list_files, read_bytes
from moseg.workflows.sources.mask_files import decode_mask
from moseg.workflows.sources.pillow_image import PILLOW_ERRORS, open_quietly

_EXIF_ORIENTATION = 0x0112
_QUARTER_TURNS = range(5, 9)
"""Values of the EXIF orientation (EXIF 2.32, 4.6.4) that exchange width and height."""


@dataclass(frozen=True)
class SavedSegmentation:
    """The masks and motions of one sequence, on disk.

    Attributes
    ----------
    folder : Path
        Holds ``masks`` and ``motion.json``.
    summary : SequenceSummary
    names : tuple of str
        File names of the frames, one each; those of a video are ``00000.png`` and so on.
    origin : FrameOrigin or None
        Where the frames come from, if formats with frames are to be written.
    kept : tuple of int or None
        Which of the frames `names`, `labels` and `frames` give, ascending, counted from 0; all where None.
    """

    folder: Path
    summary: SequenceSummary
    names: tuple[str, ...]
    origin: FrameOrigin | None = None
    kept: tuple[int, ...] | None = None

    @property
    def stems(self) -> tuple[str, ...]:
        """Names of the frames without their suffixes."""
        return tuple(Path(name).stem for name in self.names)

    def labels(self) -> Iterator[np.ndarray]:
        """Yield the labels of each frame, uint16 (y, x), 0 = static, else an identity; one in memory at a time.

        Raises
        ------
        InputError
            A mask cannot be read, or contains an object that the summary does not name.
        """
        known = {entry.identity for entry in self.summary.objects}
        for index in range(self.summary.num_frames) if self.kept is None else self.kept:
            path = self.folder / MASKS / mask_name(index)
            labels = decode_mask(read_bytes(str(path)), str(path), "instance")
            unknown = {*list_identities(labels)} - known
            if unknown:
                got, expected = f"identity {min(unknown)}", f"those of {MOTION}"
                raise InputError("mask of an unknown object", where=path, got=got, expected=expected)
            yield labels

    def frames(self) -> Iterator[np.ndarray]:
        """Yield each frame at its own size, uint8 (y, x, 3) RGB.

        Raises
        ------
        InputError
            There is no video to read them from, or it is not the one that was segmented.
        """
        origin = required_origin(self.origin)
        size = (self.summary.height, self.summary.width)
        for image in origin.choose(self.kept).read_full():
            if image.shape[:2] != size:
                got, expected = (f"{shape[1]}x{shape[0]} px" for shape in (image.shape, size))
                raise InputError(
                    "frame of the wrong size", where=origin.path, got=got, expected=f"{expected}, as in {MOTION}"
                )
            yield image

    def pairs(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield each frame with its labels; raises InputError if their numbers differ."""
        for image, labels in zip_longest(self.frames(), self.labels()):
            if image is None or labels is None:
                raise InputError("masks and frames differ in number", where=required_origin(self.origin).path)
            yield image, labels

    def from_video(self, origin: FrameOrigin) -> "SavedSegmentation":
        """Return the segmentation with the frames of a video or a folder, whose number must be the same."""
        # A video that is known by its digest has the frames; another has to be decoded to count them.
        is_known = isinstance(origin.frames, VideoFile) and self.summary.video is not None
        if not is_known and origin.frames.num_frames() != self.summary.num_frames:
            got = f"{origin.frames.num_frames()} frames"
            raise InputError(
                "masks and frames differ in number", where=origin.path, got=got, expected=self.summary.num_frames
            )
        return replace(self, origin=origin)

    def thin(self, kept: tuple[int, ...]) -> "SavedSegmentation":
        """Return the segmentation with these frames alone."""
        return replace(self, names=tuple(self.names[index] for index in kept), kept=kept)


def required_origin(origin: FrameOrigin | None, where: object = None) -> FrameOrigin:
    """Return where frames come from; raises InputError if that is not known, or they were given as arrays."""
    if origin is None or origin.path is None:
        got, expected = "masks alone", "--video VIDEO"
        if origin is not None:
            got, expected = "frames that were given as arrays", "a video file, or a folder of frames"
        raise InputError("a format that needs the frames", where=where, got=got, expected=expected)
    return origin


def open_segmentation(
    folder: Path, images: Path | None = None, name: str | None = None, origin: FrameOrigin | None = None
) -> SavedSegmentation:
    """Open the output of `moseg segment`, and check that all masks are present and of the right size.

    Parameters
    ----------
    folder : Path
    images : Path, optional
        Folder of the frames, whose names replace those in ``motion.json``.
    name : str, optional
        Name of the sequence in place of the one in ``motion.json``.
    origin : FrameOrigin, optional
        Where the frames come from.

    Raises
    ------
    InputError
        Something is missing, or masks, summary and images do not fit each other.
    """
    folder = Path(folder)
    if not (folder / MOTION).is_file():
        expected = f"{MOTION} and {MASKS}/, as moseg segment --out leaves them"
        raise MissingInputError("no segmentation", where=folder, expected=expected)
    summary = read_motion(folder / MOTION)
    if name is not None:
        summary = summary.model_copy(update={"name": name})
    check_file_name(summary.name, "sequence", folder / MOTION if name is None else "--name")
    frames = summary.frames
    if images is not None:
        paths = list_files(str(images), IMAGE_SUFFIXES)
        frames = tuple(Path(path).name for path in paths)
        if len(frames) == summary.num_frames:
            for path in paths:
                _check_size(Path(path), summary, "image")
    for frame in frames or ():
        check_file_name(frame, "frame", images or folder / MOTION)
    if frames and len(frames) != summary.num_frames:
        where, got = images or folder / MOTION, f"{len(frames)} names of frames"
        raise InputError("masks and frames differ in number", where=where, got=got, expected=summary.num_frames)
    # Checked before anything is allocated for each frame: a damaged summary may claim any number of them.
    for path in _mask_paths(folder, summary.num_frames):
        if not path.is_file():
            raise MissingInputError("missing mask", where=path, expected=f"{summary.num_frames} masks, as in {MOTION}")
        _check_size(path, summary, "mask")
    names = frames or tuple(map(mask_name, range(summary.num_frames)))
    return SavedSegmentation(folder, summary, names, origin)


def list_identities(labels: np.ndarray) -> list[int]:
    """Return the identities in uint16 (y, x) labels, ascending, without 0."""
    return (np.flatnonzero(np.bincount(labels.ravel())[1:]) + 1).tolist()


def _mask_paths(folder: Path, num_frames: int) -> Iterator[Path]:
    return (folder / MASKS / mask_name(index) for index in range(num_frames))


def _check_size(path: Path, summary: SequenceSummary, what: str) -> None:
    """Raise InputError where an image, of which only the header is read, does not have the sequence's size."""
    try:
        with open_quietly(path) as image:
            width, height = image.size
            is_turned = image.getexif().get(_EXIF_ORIENTATION) in _QUARTER_TURNS
    except PILLOW_ERRORS as error:
        raise InputError(f"{what} cannot be decoded", where=path) from error
    if (width, height) != (summary.width, summary.height):
        expected = f"{summary.width}x{summary.height} px, as in {MOTION}"
        got = f"{width}x{height} px"
        if is_turned and (height, width) == (summary.width, summary.height):
            got, expected = f"{got} and an EXIF orientation that turns them", f"{expected}, turned without EXIF"
        raise InputError(f"{what} of the wrong size", where=path, got=got, expected=expected)
