"""Events of a run: what is written to its log, one JSON object a line.

``{"time":"2026-11-22T00:43:18.123456Z","host":"node7","pid":4312,"event":"computed","ref":"flow/…","seconds":0.31}``

Every line has its kind and its time, by the clock of the process that wrote it. What an artifact's line is about stands
in ``ref``, whose part before the slash is the stage.
"""

from collections.abc import Iterable
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import AwareDatetime, Field, JsonValue, TypeAdapter

from moseg.schemas.frozen import Frozen
from moseg.schemas.recipes import Ref, split_ref


class EventKind(StrEnum):
    """What happened."""

    OPENED = "opened"
    """The run has something to compute."""
    SUBJECT = "subject"
    """What the run is about: a command's configuration, and sequences down to their leaves."""
    PLANNED = "planned"
    """The artifact is not stored and will be computed."""
    HIT = "hit"
    """The artifact is stored, and what is computed or asked for reads it."""
    STARTED = "started"
    """The call that computes the artifact began; a call takes its artifacts in the order of their lines."""
    COMPUTED = "computed"
    """The stage's function returned."""
    COMMITTED = "committed"
    """The artifact is stored."""
    LOST_RACE = "lost-race"
    """Another process had stored the artifact before this one could: its copy stays."""
    DEGENERATE = "degenerate"
    """The artifact holds fits that the data do not determine; it is a result like any other."""
    FAILED = "failed"
    """The artifact could not be computed, or, without a ``ref``, the run could not go on."""
    QUARANTINED = "quarantined"
    """The stored artifact was found damaged and taken out of service."""
    CLOSED = "closed"
    """The run ended and could say so."""


class Outcome(StrEnum):
    """How a run ended."""

    FINISHED = "finished"
    FAILED = "failed"
    INTERRUPTED = "interrupted"


class _Line(Frozen):
    time: AwareDatetime


class _ProcessLine(_Line):
    host: str
    pid: int


class RunOpened(_ProcessLine):
    """First line of a run.

    Attributes
    ----------
    space : str
        Space in which `pid` means something, see `moseg.store.owners`.
    command : tuple of str
        Words of the command line; `folder` is where it was given.
    num_workers : int
        Calls that run at the same time.
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
    """A sequence or clip: its leaves by the names that the graph gives them, and frames per second where it has any."""

    leaves: dict[str, JsonValue]
    fps: float | None = None


class SubjectEvent(_ProcessLine):
    """What a run is about, of one wave of sequences: enough to write the graph again without its sources.

    Attributes
    ----------
    command : 'eval', 'ablate' or 'segment'
    dataset : str or None
        None for a user's own video.
    variants : tuple of str
    config : dict
        Every parameter, as another version of the schema may know it.
    seeds : tuple of int or None
        Seeds that figures are means over, where several runs on trajectories were asked for.
    notes : tuple of str
        What a reader must know to read the figures rightly.
    sequences : tuple of SequenceSubject
    """

    event: Literal[EventKind.SUBJECT] = EventKind.SUBJECT
    command: Literal["eval", "ablate", "segment"]
    dataset: str | None = None
    variants: tuple[str, ...]
    config: dict[str, JsonValue]
    seeds: tuple[int, ...] | None = None
    notes: tuple[str, ...] = ()
    sequences: tuple[SequenceSubject, ...]


class PlanEvent(_Line):
    """An artifact that the client will have computed, or that it found."""

    event: Literal[EventKind.PLANNED, EventKind.HIT]
    ref: Ref

    @property
    def stage(self) -> str:
        """Stage of the artifact."""
        return split_ref(self.ref)[0]


class WorkEvent(_ProcessLine):
    """A step of an artifact's computation, by the process that took it; `seconds` inside the stage's function."""

    event: Literal[EventKind.STARTED, EventKind.COMPUTED, EventKind.COMMITTED, EventKind.LOST_RACE]
    ref: Ref
    seconds: float | None = None

    @property
    def stage(self) -> str:
        """Stage of the artifact."""
        return split_ref(self.ref)[0]


class DegenerateEvent(_ProcessLine):
    """Fits of a computed artifact that are not valid: how many, of how many, and for which reasons as far as known."""

    event: Literal[EventKind.DEGENERATE] = EventKind.DEGENERATE
    ref: Ref
    num_invalid: int
    num_fits: int
    reasons: dict[str, int] = {}

    @property
    def stage(self) -> str:
        """Stage of the artifact."""
        return split_ref(self.ref)[0]


class TroubleEvent(_ProcessLine):
    """A failure, or damage that was found."""

    event: Literal[EventKind.FAILED, EventKind.QUARANTINED]
    ref: Ref | None = None
    message: str

    @property
    def stage(self) -> str | None:
        """Stage of the artifact, where it is about one."""
        return None if self.ref is None else split_ref(self.ref)[0]


Event = Annotated[
    RunOpened | RunClosed | SubjectEvent | PlanEvent | WorkEvent | DegenerateEvent | TroubleEvent,
    Field(discriminator="event"),
]

_BEGIN = b'{"time":"'
_EVENT: TypeAdapter[Event] = TypeAdapter(Event)


def write_event(event: Event) -> bytes:
    """The event's line, its end included."""
    return event.model_dump_json(exclude_none=True).encode("utf-8") + b"\n"


def write_plan(event: PlanEvent, refs: Iterable[str]) -> Iterable[bytes]:
    """Lines that differ from the event's own in nothing but the reference: of a long plan in a moment."""
    before, _, behind = write_event(event).partition(event.ref.encode("ascii"))
    return (before + ref.encode("ascii") + behind for ref in refs)


def line_time(line: bytes) -> bytes:
    """A line's time as text that sorts as the times do: every line begins with it, in UTC."""
    # Whole seconds have no fraction, and "18Z" would come behind "18.5Z".
    return line[len(_BEGIN) : line.find(b'"', len(_BEGIN))].removesuffix(b"Z")


def read_event(line: bytes) -> Event:
    """The event of a line; raises pydantic.ValidationError where it is none."""
    return _EVENT.validate_json(line)
