"""The client's part of a run's log: what was planned and found, and how the run ended."""

import os
import shlex
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import version
from itertools import islice

from moseg.schemas.errors import CorruptArtifactError, StoreError
from moseg.schemas.events import (
    EventKind,
    Outcome,
    PlanEvent,
    RunClosed,
    RunOpened,
    SubjectEvent,
    TroubleEvent,
    write_event,
    write_plan,
)
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import ArtifactStore
from moseg.store.owners import process_space
from moseg.workflows.process.notebook import print_notice
from moseg.workflows.runlog.choices import read_choices
from moseg.workflows.runlog.events import EventLog, as_unicode, describe_error, failed_event, is_written, this_process

MAX_REMEMBERED = 50_000
"""References of which a log remembers that it has them.

A page that stays open computes a few for every value of a slider. Beyond this many the oldest are forgotten, and
written again if they are planned again: readers count each once."""


class RunLog:
    """The client's part of a run's log.

    It begins when there is something to compute. A run that finds everything in the store leaves no log: nothing
    happened, and its store may be read-only.

    Attributes
    ----------
    choices : dict of str to tuple of StretchChoice
        Sources of proposals chosen for the subject's sequences, by name.
    """

    def __init__(self, store: ArtifactStore, run_id: str, quiet: bool = False):
        self._store = store
        self._run_id = run_id
        self._quiet = quiet
        self._events = EventLog(store, run_id)
        self._is_open = False
        self._is_announced = False
        self._outcome, self._error = Outcome.FINISHED, None
        self._written: dict[str, EventKind] = {}
        self._subjects: dict[tuple, SubjectEvent | None] = {}
        self.choices: dict[str, tuple[StretchChoice, ...]] = {}

    @property
    def is_open(self) -> bool:
        """True between the start and the end of the log."""
        return self._is_open

    def open(self, num_workers: Callable[[], int]) -> None:
        """Begin the log; later calls do nothing. The number of workers may take a request to a scheduler."""
        if self._is_open:
            return
        opened = RunOpened(
            run_id=self._run_id,
            space=process_space(),
            command=tuple(map(as_unicode, (os.path.basename(sys.argv[0]), *sys.argv[1:]))),
            folder=as_unicode(os.getcwd()),
            version=version("moseg"),
            num_workers=num_workers(),
            **this_process(),
        )
        self._events.write([opened])
        self._is_open = True
        self._write_subjects()

    def describe(self, subject: SubjectEvent) -> None:
        """Write the subject of the run, each wave of sequences once: now, or when the log begins."""
        self.choices |= read_choices(subject)
        self._subjects.setdefault(tuple(sequence.leaves["name"] for sequence in subject.sequences), subject)
        if self._is_open:
            self._write_subjects()

    def announce(self) -> None:
        """Print once how to follow the run: on standard error, or below the cell of a notebook."""
        if not self._quiet and not self._is_announced:
            command = shlex.join(["moseg", "status", self._run_id, "--store", self._store.url])
            print_notice(f"run {self._run_id} ({command})")
        self._is_announced = True

    def plan(self, computed: Collection[str], reused: Collection[str] = ()) -> None:
        """Write which artifacts will be computed and which are reused, unless an earlier plan of the run did."""
        self._plan(EventKind.PLANNED, computed)
        self._plan(EventKind.HIT, reused)

    def quarantined(self, error: CorruptArtifactError) -> None:
        """Write that the artifact named by an error was quarantined; another plan includes it anew."""
        self._written.pop(error.ref, None)
        event = TroubleEvent(event=EventKind.QUARANTINED, ref=error.ref, message=str(error), **this_process())
        self._events.write([event])

    @contextmanager
    def watch(self) -> Iterator[None]:
        """Record how the block ends, for `close`."""
        try:
            yield
        except Exception as error:
            self._outcome, self._error = Outcome.FAILED, error
            if self._is_open and not is_written(error):
                # Keep the original error if logging also fails.
                with suppress(StoreError):
                    self._events.write([failed_event(error)])
            raise
        except BaseException:
            self._outcome = Outcome.INTERRUPTED
            raise
        self._outcome, self._error = Outcome.FINISHED, None

    def close(self, pins: tuple[str, ...] = ()) -> None:
        """End the log, if it was begun, with the names of the pins that keep the results."""
        if not self._is_open:
            return
        self._is_open = False
        message = None if self._error is None else describe_error(self._error)
        closed = RunClosed(outcome=self._outcome, message=message, pins=pins, **this_process())
        if self._outcome == Outcome.FINISHED:
            self._events.write([closed])
            return
        with suppress(StoreError):
            self._events.write([closed])

    def _write_subjects(self) -> None:
        new = {names: subject for names, subject in self._subjects.items() if subject is not None}
        # After it is written only its names are kept: a wave's leaves take a megabyte.
        self._subjects.update(dict.fromkeys(new))
        now = this_process()["time"]
        self._events.write_lines(write_event(subject.model_copy(update={"time": now})) for subject in new.values())

    def _plan(self, kind: EventKind, refs: Collection[str]) -> None:
        new = [ref for ref in refs if self._written.get(ref) != kind]
        if new:
            self._written.update(dict.fromkeys(new, kind))
            for oldest in list(islice(self._written, max(0, len(self._written) - MAX_REMEMBERED))):
                del self._written[oldest]
            sample = PlanEvent(event=kind, ref=new[0], time=this_process()["time"])
            self._events.write_lines(write_plan(sample, new))
