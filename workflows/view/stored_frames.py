"""Frames of a result as its store has them: the video itself may have been removed."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.events import VideoFrames
from moseg.store import ArtifactStore
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary, read_motion
from moseg.workflows.exports.outputs import MOTION
from moseg.workflows.sources.frames import FrameDescription
from moseg.workflows.view.stored_runs import StoredRun


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
class StoredOrigin(FrameOrigin):
    """Origin of the frames of a stored result, without the video itself.

    Attributes
    ----------
    video : str or None
        Digest of the video.
    recorded_frames : VideoFrames or None
        Frames of the video that were read; None if this is not known.
    """

    video: str | None
    recorded_frames: VideoFrames | None

    @property
    def names(self) -> tuple[str, ...] | None:
        """See `FrameOrigin`."""
        return None if self.recorded_frames is None else self.recorded_frames.names

    @property
    def numbers(self) -> tuple[int, ...] | None:
        """See `FrameOrigin`."""
        return None if self.recorded_frames is None else self.recorded_frames.numbers

    @property
    def identity(self) -> str | None:
        """See `FrameOrigin`."""
        return self.video

    @property
    def part(self) -> str | None:
        """See `FrameOrigin`; None too for images of which it is not known whether the folder has others."""
        recorded = None if self.recorded_frames is None else self.recorded_frames.part
        return recorded or super().part

    def recorded(self) -> VideoFrames | None:
        """See `FrameOrigin`."""
        return self.recorded_frames


def find_origin(frames: StoredFrames, run: StoredRun, out: Path, summary: SequenceSummary | None) -> StoredOrigin:
    """Return the origin of the frames of a run.

    Parameters
    ----------
    out : Path
        Output folder. Its ``motion.json`` counts for a run of an earlier version, whose log does not have the frames.
    summary : SequenceSummary or None
        What the output folder has of the run, if that is what is opened.

    Raises
    ------
    InputError
        ``motion.json`` is needed and cannot be read.
    """
    recorded = run.video_frames
    if summary is None and recorded is None:
        summary = _read_summary(run, out)
    if summary is None:
        return StoredOrigin(None, frames, run.video, recorded)
    saved = summary.frames, summary.numbers
    if recorded is None or (recorded.names, recorded.numbers) != saved:
        recorded = VideoFrames(names=summary.frames, numbers=summary.numbers)
    return StoredOrigin(None, frames, summary.video, recorded)


def _read_summary(run: StoredRun, out: Path) -> SequenceSummary | None:
    """Return what a folder has of the same video and as many frames; None if it has none or those of another one."""
    path = out / MOTION
    if run.video is None or not path.is_file():
        return None
    summary = read_motion(path)
    is_same = (summary.video, summary.num_frames) == (run.video, len(run.leaves.frames))
    return summary if is_same else None
