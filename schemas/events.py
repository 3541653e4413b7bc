"""Events of a run, written to its log as one JSON object per line.

``{"time":"2026-11-22T00:43:18.123456Z","host":"node7","pid":4312,"event":"computed","ref":"flow/…","seconds":0.31}``

Every line has its kind and its time, by the clock of the process that wrote it. ``ref`` is the reference of the
artifact that a line is about; its part before the slash is the stage.
"""

from collections.abc import Iterable
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import AwareDatetime, Field, JsonValue, TypeAdapter

from moseg.schemas.frozen import Frozen
from moseg.schemas.recipes import Ref, split_ref


class EventKind(StrEnum):
    """Kind of an event."""

    OPENED = "opened"
    """The run has something to compute."""
    SUBJECT = "subject"
    """The subject of the run: a command's configuration, and sequences with their leaves."""
    PLANNED = "planned"
    """The artifact is not stored and will be computed."""
    HIT = "hit"
    """The artifact is stored, and it is requested or read by a computed one."""
    STARTED = "started"
    """The call that computes the artifact began; a call computes its artifacts in the order of their lines."""
    COMPUTED = "computed"
    """The stage's function returned."""
    COMMITTED = "committed"
    """The artifact is stored."""
    LOST_RACE = "lost-race"
    """Another process stored the artifact first: its copy is kept."""
    DEGENERATE = "degenerate"
    """The artifact contains fits that the data do not determine; it is a valid result."""
    FAILED = "failed"
    """The artifact could not be computed or, without a ``ref``, the run could not continue."""
    QUARANTINED = "quarantined"
    """The stored artifact was found damaged and is no longer read."""
    CLOSED = "closed"
    """The run ended and could write this event."""


class Outcome(StrEnum):
    """Outcome of a run."""

    FINISHED = "finished"
    FAILED = "failed"
    INTERRUPTED = "interrupted"


class _Line(Frozen):
    time: AwareDatetime


class _ProcessLine(_Line):
    host: str
    pid: int


class _OfArtifact:
    """Events about one artifact, which have a field `ref`."""

    @property
    def stage(self) -> str:
        """Stage of the artifact."""
        return split_ref(self.ref)[0]


class RunOpened(_ProcessLine):
    """First line of a run.

    Attributes
    ----------
    space : str
        Space in which `pid` is valid, see `moseg.store.owners`.
    command : tuple of str
        Words of the command line; `folder` is its working directory.
    num_workers : int
        Number of calls that run at the same time.
    """

    event: Literal[EventKind.OPENED] = EventKind.OPENED
    run_id: str
    space: str
    command: tuple[str, ...]
    folder: str
    version: str
    num_workers: int


class RunClosed(_ProcessLine):
    """Last line of a run: its outcome, the error that ended it, and the pins that keep its results."""

    event: Literal[EventKind.CLOSED] = EventKind.CLOSED
    outcome: Outcome
    message: str | None = None
    pins: tuple[str, ...] = ()


class SequenceSubject(Frozen):
    """A sequence or clip: its leaves by their names in the graph, and frames per second if it has any."""

    leaves: dict[str, JsonValue]
    fps: float | None = None


class VideoFrames(Frozen):
    """Frames of the user's video, or folder of images, that a run read.

    Attributes
    ----------
    names : tuple of str or None
        File names, one each; None for a video.
    numbers : tuple of int or None
        Numbers in the video, counted from 0, one each; None if all were read, or if they have names.
    part : str or None
        Part of the video that they are, in words; None if all were read, or if this is not known.
    """

    names: tuple[str, ...] | None = None
    numbers: tuple[int, ...] | None = None
    part: str | None = None


class SubjectEvent(_ProcessLine):
    """The subject of a run for one wave of sequences: sufficient to write the graph again without its sources.

    Attributes
    ----------
    command : 'eval', 'ablate' or 'segment'
    dataset : str or None
        None for a user's own video.
    variants : tuple of str
    config : dict
        Every parameter, possibly of another version of the schema.
    seeds : tuple of int or None
        Seeds over which figures are averaged, if several runs on trajectories were requested.
    notes : tuple of str
        Remarks that a reader needs to interpret the figures.
    words : tuple of str or None
        Command line without `moseg` that leads to the same, of a run that continues another.
    video : str or None
        Digest of the user's video, as in ``motion.json``.
    video_frames : VideoFrames or None
        Its frames; None in runs of earlier versions, and where JSON cannot hold their names.
    uncorrected : dict or None
        Every parameter before the settings of the user's corrections, if there are any.
    sequences : tuple of SequenceSubject
    """

    event: Literal[EventKind.SUBJECT] = EventKind.SUBJECT
    command: Literal["eval", "ablate", "segment"]
    dataset: str | None = None
    variants: tuple[str, ...]
    config: dict[str, JsonValue]
    seeds: tuple[int, ...] | None = None
    notes: tuple[str, ...] = ()
    words: tuple[str, ...] | None = None
    video: str | None = None
    video_frames: VideoFrames | None = None
    uncorrected: dict[str, JsonValue] | None = None
    sequences: tuple[SequenceSubject, ...]


class PlanEvent(_OfArtifact, _Line):
    """An artifact that is planned or was found."""

    event: Literal[EventKind.PLANNED, EventKind.HIT]
    ref: Ref


class WorkEvent(_OfArtifact, _ProcessLine):
    """A step of an artifact's computation, by the process that ran it; `seconds` inside the stage's function."""

    event: Literal[EventKind.STARTED, EventKind.COMPUTED, EventKind.COMMITTED, EventKind.LOST_RACE]
    ref: Ref
    seconds: float | None = None


class DegenerateEvent(_OfArtifact, _ProcessLine):
    """Invalid fits of a computed artifact: their number, the number of all, and the known reasons."""

    event: Literal[EventKind.DEGENERATE] = EventKind.DEGENERATE
    ref: Ref
    num_invalid: int
    num_fits: int
    reasons: dict[str, int] = {}


class TroubleEvent(_ProcessLine):
    """A failure, or a damaged artifact."""

    event: Literal[EventKind.FAILED, EventKind.QUARANTINED]
    ref: Ref | None = None
    message: str

    @property
    def stage(self) -> str | None:
        """Return the stage of the artifact, or None without one."""
        return None if self.ref is None else split_ref(self.ref)[0]


Event = Annotated[
    RunOpened | RunClosed | SubjectEvent | PlanEvent | WorkEvent | DegenerateEvent | TroubleEvent,
    Field(discriminator="event"),
]

_BEGIN = b'{"time":"'
_EVENT: TypeAdapter[Event] = TypeAdapter(Event)


def write_event(event: Event) -> bytes:
    """Return the event's line, including its end."""
    return event.model_dump_json(exclude_none=True).encode("utf-8") + b"\n"


def write_plan(event: PlanEvent, refs: Iterable[str]) -> Iterable[bytes]:
    """Return the event's line with each of the references: fast for a long plan."""
    before, _, behind = write_event(event).partition(event.ref.encode("ascii"))
    return (before + ref.encode("ascii") + behind for ref in refs)


def line_time(line: bytes) -> bytes:
    """Return a line's time as text that sorts in the order of time: every line begins with it, in UTC."""
    # Whole seconds have no fraction, and "18Z" would be sorted after "18.5Z".
    return line[len(_BEGIN) : line.find(b'"', len(_BEGIN))].removesuffix(b"Z")


def read_event(line: bytes) -> Event:
    """Return the event of a line; raise pydantic.ValidationError if it is not one."""
    return _EVENT.validate_json(line)
