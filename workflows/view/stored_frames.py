"""Frames of a result as its store has them: the video itself may have been removed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.store import ArtifactStore
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.sources.frames import FrameDescription


class StoredFrames(NamedTuple):
    """Frames as analysed, with the description of the video that they come from.

    Attributes
    ----------
    store : ArtifactStore
    refs : tuple of references
    description : FrameDescription
    """

    store: ArtifactStore
    refs: tuple[str, ...]
    description: FrameDescription

    @classmethod
    def of_size(
        cls, store: ArtifactStore, refs: tuple[str, ...], size: tuple[int, int], fps: float | None
    ) -> "StoredFrames":
        """Return the frames of a video of this (height, width)."""
        return cls(store, refs, FrameDescription(tuple(size), fps))

    def fingerprint(self) -> str:
        """See `FrameSource`."""
        return digest_json("stored", self.refs)

    def read(self) -> Iterator[np.ndarray]:
        """See `FrameSource`."""
        for ref in self.refs:
            yield self.store.read(ref, "image")

    def describe(self) -> FrameDescription:
        """See `FrameSource`."""
        return self.description

    def num_frames(self) -> int:
        """See `FrameSource`."""
        return len(self.refs)

    def chunks(self, size: int) -> tuple["StoredFrames", ...]:
        """See `FrameSource`."""
        return tuple(self._replace(refs=self.refs[start : start + size]) for start in range(0, len(self.refs), size))


@dataclass(frozen=True)
class RunOrigin(FrameOrigin):
    """Origin of the frames of a run, as its log has it.

    Attributes
    ----------
    video : str or None
        Digest of the video.
    """

    video: str | None

    @property
    def identity(self) -> str | None:
        """See `FrameOrigin`."""
        return self.video


@dataclass(frozen=True)
class StoredOrigin(FrameOrigin):
    """Origin of the frames of a result whose video is not known, as ``motion.json`` describes it.

    Attributes
    ----------
    summary : SequenceSummary
    """

    summary: SequenceSummary

    @property
    def names(self) -> tuple[str, ...] | None:
        """See `FrameOrigin`."""
        return self.summary.frames

    @property
    def numbers(self) -> tuple[int, ...] | None:
        """See `FrameOrigin`."""
        return self.summary.numbers

    @property
    def identity(self) -> str | None:
        """See `FrameOrigin`."""
        return self.summary.video
