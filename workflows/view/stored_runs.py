"""Finished runs of `moseg segment` in a store."""

from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.events import VideoFrames
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceLeaves
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.runlog.status import RunStatus, find_run, list_runs, read_status

MAX_LISTED = 30
"""Runs that the page offers, the latest ones."""


class StoredRun(NamedTuple):
    """A run of `moseg segment` on one video.

    Attributes
    ----------
    status : RunStatus
    leaves : SequenceLeaves
    config : PipelineConfig
    uncorrected : PipelineConfig
        Without the settings of corrections.
    variant : Variant
    fps : float or None
    video : str or None
        Digest of the video; None in runs of earlier versions, and for arrays.
    words : tuple of str
        Its command line without `moseg`; for a run that continues another, that of the other one.
    video_frames : VideoFrames or None
        The frames of the video that were read; None in runs of earlier versions.
    """

    status: RunStatus
    leaves: SequenceLeaves
    config: PipelineConfig
    uncorrected: PipelineConfig
    variant: Variant
    fps: float | None
    video: str | None
    words: tuple[str, ...]
    video_frames: VideoFrames | None = None

    @property
    def numbers(self) -> tuple[int, ...] | None:
        """Numbers of the frames in the video; None if all were read, if they have names, or if they are not known."""
        return None if self.video_frames is None else self.video_frames.numbers


def read_run(store: ArtifactStore, name: str) -> StoredRun:
    """Return the run of this name, the only one whose name begins so, or the latest.

    Raises
    ------
    InputError
        There is none, or it is not one of `moseg segment`.
    """
    run_id = find_run(store, name)
    subject = read_subject(store, run_id)
    if subject.command != "segment":
        got, expected = f"a run of moseg {subject.command}", "a run of moseg segment, which has one video"
        raise InputError("a run that cannot be viewed", where=f"run {run_id}", got=got, expected=expected)
    (sequence, *_), (variant, *_) = subject.sequences, subject.variants
    status = read_status(store, run_id)
    words = subject.words or status.command[1:]
    uncorrected = subject.uncorrected or subject.config
    return StoredRun(
        status=status,
        leaves=sequence.leaves,
        config=subject.config,
        uncorrected=uncorrected,
        variant=variant,
        fps=sequence.fps,
        video=subject.video,
        words=words,
        video_frames=subject.video_frames,
    )


def list_segmentations(store: ArtifactStore) -> list[dict]:
    """Return name, video and number of frames of the latest runs that can be viewed, as JSON."""
    return [
        {"run": run.status.run_id, "name": run.leaves.name, "frames": len(run.leaves.frames)}
        for run in islice(readable_runs(store), MAX_LISTED)
    ]


def readable_runs(store: ArtifactStore) -> Iterator[StoredRun]:
    """Yield the runs of `moseg segment` whose logs can be read, the latest first."""
    for run_id in list_runs(store):
        try:
            yield read_run(store, run_id)
        except (InputError, StoreError):
            # Of another command, of another version, or damaged: not one to offer.
            continue
