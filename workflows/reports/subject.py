"""Subject of a run, read from its log: enough to write its graph again without the sources."""

import json
from typing import Literal, NamedTuple

from pydantic import TypeAdapter, ValidationError

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.errors import InputError
from moseg.schemas.events import EventKind, SubjectEvent, VideoFrames, line_time, read_event
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceLeaves, TrajectoryLeaves

_LEAVES = {True: TypeAdapter(SequenceLeaves), False: TypeAdapter(TrajectoryLeaves)}
_MARK = f'"{EventKind.SUBJECT}"'.encode("ascii")


class RunSequence(NamedTuple):
    """A sequence or clip of a run, and its frames per second where it has any."""

    leaves: SequenceLeaves | TrajectoryLeaves
    fps: float | None


class RunSubject(NamedTuple):
    """Subject of a run.

    Attributes
    ----------
    command : 'eval', 'ablate' or 'segment'
    dataset : str or None
        None for a user's own video.
    config : PipelineConfig
    variants : tuple of Variant, or of TrajectoryVariant
    sequences : tuple of RunSequence
        Of all waves that the run reached.
    seeds : tuple of int or None
        Seeds over which figures are averaged.
    notes : tuple of str
    words : tuple of str or None
        Command line without `moseg` that leads to the same, of a run that continues another.
    video : str or None
        Digest of the user's video; None in runs of earlier versions too.
    video_frames : VideoFrames or None
        Its frames, where the log has them.
    uncorrected : PipelineConfig or None
        The configuration before the settings of the user's corrections, if there are any.
    """

    command: Literal["eval", "ablate", "segment"]
    dataset: str | None
    config: PipelineConfig
    variants: tuple[Variant, ...] | tuple[TrajectoryVariant, ...]
    sequences: tuple[RunSequence, ...]
    seeds: tuple[int, ...] | None = None
    notes: tuple[str, ...] = ()
    words: tuple[str, ...] | None = None
    video: str | None = None
    uncorrected: PipelineConfig | None = None
    video_frames: VideoFrames | None = None

    @property
    def has_frames(self) -> bool:
        """Whether its subject is frames, not trajectories without images."""
        return isinstance(self.sequences[0].leaves, SequenceLeaves)


def read_subject(store: ArtifactStore, run_id: str) -> RunSubject:
    """Read the subject of a run from its log; a note counts lines that are cut short.

    Raises
    ------
    InputError
        The log does not name it, or names fields that this version of the configuration or the graph does not have.
    StoreError
        The log cannot be read.
    """
    # A large run has a hundred thousand other lines.
    lines = sorted((line for line in store.read_log(run_id) if _MARK in line), key=line_time)
    where = f"run {run_id}"
    whole = [line for line in lines if _is_json(line)]
    num_broken = len(lines) - len(whole)
    try:
        events = [event for event in map(read_event, whole) if isinstance(event, SubjectEvent)]
        if not events:
            expected = "a run of moseg eval, ablate or segment that got as far as its first plan"
            got = f"{num_broken} of {len(lines)} lines about it cut short" if num_broken else None
            raise InputError("nothing to report", where=where, got=got, expected=expected)
        subject = _read(events)
        if not num_broken:
            return subject
        note = f"{num_broken} of {len(lines)} lines of its log about its sequences are cut short: those are missing"
        return subject._replace(notes=(*subject.notes, note))
    except ValidationError as error:
        first = error.errors()[0]
        got = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        expected = "a run of this version; the run's own command, given again, makes one"
        what = "a run of another version of moseg, or of a plug-in that is not installed"
        raise InputError(what, where=where, got=got, expected=expected) from error


def _is_json(line: bytes) -> bool:
    """Return whether a line is complete: a full disk or a kill can cut one short."""
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return False
    return True


def _read(events: list[SubjectEvent]) -> RunSubject:
    first = events[0]
    sequences = tuple(
        RunSequence(_LEAVES["frames" in sequence.leaves].validate_python(sequence.leaves), sequence.fps)
        for event in events
        for sequence in event.sequences
    )
    kind = Variant if isinstance(sequences[0].leaves, SequenceLeaves) else TrajectoryVariant
    return RunSubject(
        command=first.command,
        dataset=first.dataset,
        config=PipelineConfig.model_validate(first.config),
        variants=TypeAdapter(tuple[kind, ...]).validate_python(first.variants),
        sequences=sequences,
        seeds=first.seeds,
        notes=first.notes,
        words=first.words,
        video=first.video,
        video_frames=first.video_frames,
        uncorrected=None if first.uncorrected is None else PipelineConfig.model_validate(first.uncorrected),
    )
