"""Frames whose description was read once: it stays known if their files are removed."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from moseg.workflows.sources.frames import FrameDescription, FrameSource


class DescribedFrames(NamedTuple):
    """A source of frames, and its description.

    Attributes
    ----------
    frames : FrameSource
    description : FrameDescription
    """

    frames: FrameSource
    description: FrameDescription

    def fingerprint(self) -> str:
        """See `FrameSource`."""
        return self.frames.fingerprint()

    def read(self) -> Iterator[np.ndarray]:
        """See `FrameSource`."""
        return self.frames.read()

    def describe(self) -> FrameDescription:
        """See `FrameSource`."""
        return self.description

    def num_frames(self) -> int:
        """See `FrameSource`."""
        return self.frames.num_frames()

    def chunks(self, size: int) -> tuple[FrameSource, ...]:
        """See `FrameSource`."""
        return self.frames.chunks(size)
