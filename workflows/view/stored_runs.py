"""Finished runs of `moseg segment` in a store: their names, and the one whose results lie in a folder."""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.errors import InputError, MissingArtifactError, StoreError
from moseg.schemas.events import VideoFrames
from moseg.store import ArtifactStore
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.exports.outputs import MASKS, mask_name
from moseg.workflows.graph import SequenceLeaves, make_graph
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.results.shown_frames import spread
from moseg.workflows.runlog.status import RunStatus, find_run, list_runs, read_status
from moseg.workflows.sources.files import read_bytes
from moseg.workflows.sources.mask_files import decode_mask
from moseg.workflows.sources.resize import resize_labels

MAX_LISTED = 30
"""Runs that the page offers, the latest ones."""
COMPARED_FRAMES = 5
"""Frames, spread over the video, whose masks tell whether a folder has the results of a run."""


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
        for run in islice(_readable_runs(store), MAX_LISTED)
    ]


def find_run_of(store: ArtifactStore, folder: Path, summary: SequenceSummary, is_corrected: bool) -> StoredRun:
    """Return the latest run whose results a folder has.

    Parameters
    ----------
    is_corrected : bool
        Whether the masks may be corrected ones, so that they are not those of the run.

    Raises
    ------
    InputError
        The store has no such run.
    """
    for run in _readable_runs(store):
        if (run.leaves.name, len(run.leaves.frames)) != (summary.name, summary.num_frames):
            continue
        if None not in (run.video, summary.video) and run.video != summary.video:
            continue
        if None not in (run.numbers, summary.numbers) and run.numbers != summary.numbers:
            continue
        try:
            if is_corrected or _has_masks_of(store, run, folder, summary):
                return run
        except MissingArtifactError:
            continue
    expected = "`moseg view VIDEO --out` with this folder, which computes what is missing; or the run's own --store"
    raise InputError("the results behind these masks are not stored", where=folder, got=store.url, expected=expected)


def _readable_runs(store: ArtifactStore) -> Iterator[StoredRun]:
    """Yield runs of `moseg segment` whose logs can be read, the latest first."""
    for run_id in list_runs(store):
        try:
            yield read_run(store, run_id)
        except (InputError, StoreError):
            # Of another command, of another version, or damaged: not one to offer.
            continue


def _has_masks_of(store: ArtifactStore, run: StoredRun, folder: Path, summary: SequenceSummary) -> bool:
    """Return whether some masks of a folder are those that a run computed."""
    graph = make_graph(run.leaves, run.config)
    refs = graph.segmentations(run.variant)
    for frame in spread(summary.num_frames, COMPARED_FRAMES):
        section, row = graph.place(frame)
        labels = store.read_rows(refs[section], "labels", row, row + 1)[0]
        path = str(folder / MASKS / mask_name(frame))
        saved = decode_mask(read_bytes(path), path, "instance")
        if not np.array_equal(resize_labels(labels, saved.shape), saved):
            return False
    return True
