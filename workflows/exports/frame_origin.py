"""The file or folder that the frames of a segmentation come from: their names, and the frames themselves once more."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import InputError
from moseg.schemas.events import VideoFrames
from moseg.workflows.exports.motion_json import frame_names
from moseg.workflows.sources import FrameSource, ImageFiles, VideoFile
from moseg.workflows.sources.files import open_file, unreadable

HEAD_BYTES = 1 << 20
"""Two videos that begin with the same MiB and have the same length are the same one."""


@dataclass(frozen=True)
class FrameOrigin:
    """Origin of the frames of a result.

    Attributes
    ----------
    path : str or None
        Of the video, or of the folder of images; None for frames that were given as arrays.
    frames : FrameSource
        The frames that were segmented.
    """

    path: str | None
    frames: FrameSource

    @cached_property
    def names(self) -> tuple[str, ...] | None:
        """File names of the frames of a folder, one each; None for a video. InputError is raised if JSON holds none."""
        return frame_names(self.frames)

    @property
    def numbers(self) -> tuple[int, ...] | None:
        """Numbers of the frames in the video, counted from 0; None if they are all of it, or have names."""
        return self.frames.numbers if isinstance(self.frames, VideoFile) else None

    @cached_property
    def identity(self) -> str | None:
        """Digest by which the video is known again, whichever of its frames are read; None for arrays.

        That of a folder stays if frames are appended.
        """
        if isinstance(self.frames, ImageFiles):
            return digest_bytes("origin", _head(self.frames.first_path))
        if isinstance(self.frames, VideoFile):
            path = self.frames.path
            return digest_bytes("origin", _head(path), str(Path(path).stat().st_size).encode())
        return None

    @property
    def part(self) -> str | None:
        """First and last frame of the video and how many there are, in words; None if they are all of it, or arrays."""
        if isinstance(self.frames, ImageFiles) and self.frames.folder_start is not None:
            names = self.names
            return f"{len(names)} frames, {names[0]} to {names[-1]}"
        if self.numbers is not None:
            return f"{len(self.numbers)} frames, {self.numbers[0]} to {self.numbers[-1]}"
        return None

    def recorded(self) -> VideoFrames | None:
        """Return the frames as the log of a run records them; None if JSON cannot hold their names."""
        try:
            return VideoFrames(names=self.names, numbers=self.numbers, part=self.part)
        except InputError:
            # Such names are reported where they are to be written; a run that writes no results does not need them.
            return None

    def choose(self, kept: tuple[int, ...] | None) -> "FrameOrigin":
        """Return the origin of some of the frames, counted among those of this one; of all where None."""
        if kept is None:
            return self
        numbers = kept if self.numbers is None else tuple(self.numbers[index] for index in kept)
        return replace(self, frames=self.frames.choose(numbers))

    def times(self, fps: float) -> tuple[float, ...]:
        """Return the time of each frame since the first one of the video, s; images follow each other at `fps`."""
        if not isinstance(self.frames, VideoFile):
            return tuple(index / fps for index in range(self.frames.num_frames()))
        times = tuple(self.frames.times())
        return times if self.numbers is None else tuple(times[number] for number in self.numbers)

    def read_full(self) -> Iterator[np.ndarray]:
        """Yield each frame at its own size, uint8 (y, x, 3) RGB.

        Raises
        ------
        InputError
            The frames were given as arrays, or the files changed.
        """
        if self.path is None:
            raise InputError("no frames of the video's own size", got="frames that were given as arrays")
        yield from replace(self.frames, max_side=max(self.frames.describe().size)).read()


def _head(path: str) -> bytes:
    try:
        with open_file(path) as file:
            return file.read(HEAD_BYTES)
    except OSError as error:
        raise unreadable(path, error) from error
