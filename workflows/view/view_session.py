"""The session behind the page: what is open, its corrections, and the changes that pages ask for, one after another."""

import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any, NoReturn

from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, MosegError, StoreError
from moseg.workflows.process.progress import observed_progress
from moseg.workflows.view.correction_history import CorrectionHistory, StaleEditError
from moseg.workflows.view.cue_pictures import CuePictures
from moseg.workflows.view.events import Events
from moseg.workflows.view.object_areas import ObjectAreas
from moseg.workflows.view.opened import ExportChoices, Opened
from moseg.workflows.view.shown_result import ShownResult
from moseg.workflows.view.worker import Ended, Worker

MIN_PROGRESS_SECONDS = 0.1
"""Between two events of progress."""
NUM_KEPT = 8
"""States of the result of which pages may still fetch pictures."""

Opening = Callable[[ExitStack], Opened]
"""A function that opens a result; what must stay open meanwhile goes onto the stack."""


class Phase(StrEnum):
    """State that the page shows."""

    EMPTY = "empty"
    """Nothing is open yet."""
    WORKING = "working"
    FAILED = "failed"
    READY = "ready"


@dataclass(frozen=True)
class Moment:
    """State of a session at one moment; a later one replaces it, so that it can be read in any thread.

    Attributes
    ----------
    revision : int
        Rises with every change.
    phase : Phase
    name : str
        Of what is open, or will be.
    message : str
        Why the work stopped, if it did.
    opened : Opened or None
    shown : ShownResult or None
        The result under the corrections in force.
    corrections : Corrections
    can_undo, can_redo : bool
    cues : tuple of dict
        As `CuePictures.list` has them.
    look_at : tuple of str
        What is worth a look in the result as it was written last.
    """

    revision: int
    phase: Phase
    name: str = ""
    message: str = ""
    opened: Opened | None = None
    shown: ShownResult | None = None
    corrections: Corrections = field(default_factory=Corrections)
    can_undo: bool = False
    can_redo: bool = False
    cues: tuple[dict, ...] = ()
    look_at: tuple[str, ...] = ()


class ViewSession:
    """One open result, or none yet.

    Parameters
    ----------
    out : Path
        Output folder, which has the corrections.

    Attributes
    ----------
    events : Events
    areas : ObjectAreas
    """

    def __init__(self, out: Path):
        self.out = Path(out)
        self.events = Events()
        self.areas = ObjectAreas()
        self._worker = Worker()
        self._stack = ExitStack()
        self._moment = Moment(1, Phase.EMPTY)
        self._opening: tuple[str, Opening] | None = None
        self._history: CorrectionHistory | None = None
        self._cues: CuePictures | None = None
        self._states: dict[str, ShownResult] = {}
        self._observed = self._began = 0.0
        self._publish()

    @property
    def moment(self) -> Moment:
        """The state now."""
        return self._moment

    @property
    def cues(self) -> CuePictures:
        """Pictures of the cues; raises InputError if nothing is open."""
        if self._cues is None:
            raise InputError("nothing is open")
        return self._cues

    def shown(self, key: str) -> ShownResult | None:
        """Return a state of the result by its key; None if it is too old, or never was."""
        return self._states.get(key)

    def open(
        self, name: str, opening: Opening, is_only: bool = True, refuse: Callable[[], None] = lambda: None
    ) -> Future:
        """Open a result, once; raises InputError if one is open or being opened.

        Parameters
        ----------
        is_only : bool
            Whether it is tried again if it cannot be opened; if not, the page asks for another one.
        refuse : function without arguments
            Called if it cannot be opened, before the page asks for another one.
        """
        if self._moment.phase in (Phase.WORKING, Phase.READY):
            raise InputError("a result is open already", got=name, expected="another `moseg view`")
        self._opening = (name, opening) if is_only else None
        self._change(phase=Phase.WORKING, name=name, message="")
        return self._worker.call(self._open, opening, refuse)

    def retry(self) -> Future:
        """Open again what could not be opened."""
        if self._opening is None:
            raise InputError("nothing to try again")
        return self.open(*self._opening)

    def edit(self, revision: int, edit: Any) -> Future:
        """Add one edit, as JSON has it."""
        return self._worker.call(self._reported, self._put, revision, lambda history: history.with_edit(edit), None)

    def set(self, revision: int, name: str, value: Any, gesture: object) -> Future:
        """Change a setting; those of one gesture are one step."""
        return self._worker.call(
            self._reported, self._put, revision, lambda history: history.with_setting(name, value), gesture
        )

    def step(self, revision: int, by: int) -> Future:
        """Undo, -1, or redo, +1."""
        return self._worker.call(self._reported, self._step, revision, by)

    def export(self, revision: int, choices: ExportChoices) -> Future:
        """Write the result with corrections; the future's result is the paths."""
        return self._worker.call(self._reported, self._export, revision, choices)

    def repair(self, error: CorruptArtifactError | MissingArtifactError) -> Future:
        """Compute what could not be read again, for the pictures of it."""
        return self._worker.call(self._reported, self._repair, error)

    def close(self) -> None:
        """End the work and let go of what is open."""
        self.events.close()
        self._worker.close(self._stack.close)

    def _open(self, opening: Opening, refuse: Callable[[], None]) -> None:
        try:
            with observed_progress(self._observe):
                opened = opening(self._stack)
                history = CorrectionHistory(self.out, opened.video, opened.part)
                shown = opened.correct(history.current) if history.current else opened.first
                cues = CuePictures(opened.first)
                listed = tuple(cues.list())
        except Exception as error:
            self._stack.close()
            refuse()
            self._report(error)
            phase = Phase.EMPTY if self._opening is None else Phase.FAILED
            self._change(phase=phase, message=in_words(error))
            return
        except Ended:
            self._stack.close()
            raise
        self._history, self._cues = history, cues
        self._show(shown, phase=Phase.READY, name=shown.name, opened=opened, cues=listed, look_at=opened.look_at)
        # After the page has the result; a change of it waits for one step at most.
        for step in opened.prepare:
            self._worker.spare(self._reported, step)

    def _put(self, revision: int, change: Callable[[CorrectionHistory], Corrections], gesture: object) -> None:
        history = self._checked(revision)
        corrections = change(history)
        # The result first: an edit that names an object that is not there is refused, and not written.
        self._enforce(corrections, lambda: history.put(corrections, gesture))

    def _step(self, revision: int, by: int) -> None:
        history = self._checked(revision)
        self._enforce(history.before() if by < 0 else history.after(), lambda: history.step(by))

    def _export(self, revision: int, choices: ExportChoices) -> tuple[Path, ...]:
        self._checked(revision)
        written = self._moment.opened.write(choices)
        if written.look_at != self._moment.look_at:
            self._change(look_at=written.look_at)
        return written.paths

    def _repair(self, error: CorruptArtifactError | MissingArtifactError) -> None:
        what, where = error.parts[:2]
        try:
            self._moment.opened.repair(error.ref if isinstance(error, CorruptArtifactError) else where)
        except MosegError as failed:
            expected = f"`moseg view VIDEO --out {self.out}` with the video, which computes it again ({failed})"
            raise StoreError("a part of the store cannot be read", where=where, got=what, expected=expected) from failed

    def _checked(self, revision: int) -> CorrectionHistory:
        """Return the history if a page's change is one of the state now.

        Raises
        ------
        StaleEditError
            Another page, or another program, has changed the corrections since; the state then has that change.
        """
        if self._history is None:
            raise InputError("nothing is open")
        if self._history.is_stale():
            self._take_from_file()
        if revision != self._moment.revision:
            expected = "this change once more, on the result as it is now"
            raise StaleEditError("changed in another tab meanwhile", expected=expected)
        return self._history

    def _take_from_file(self) -> NoReturn:
        """Enforce the corrections of the file, which another program has changed, and raise StaleEditError."""
        shown: list[ShownResult] = []
        self._history.reload(lambda corrections: shown.append(self._correct(corrections)))
        self._show(*shown)
        raise StaleEditError("changed by another program", where=self._history.path, expected="this change once more")

    def _enforce(self, corrections: Corrections, write: Callable[[], None]) -> None:
        """Have corrections in force, here and in the file, or neither."""
        shown = self._correct(corrections)
        # The computation may have taken a while.
        if self._history.is_stale():
            self._take_from_file()
        try:
            write()
        except Exception:
            self._correct(self._history.current)
            raise
        self._show(shown)

    def _correct(self, corrections: Corrections) -> ShownResult:
        return self._moment.opened.correct(corrections)

    def _reported(self, work: Callable[..., Any], *arguments: Any) -> Any:
        """Return what `work` returns; what a page is told of a failure is one line on the terminal too."""
        try:
            return work(*arguments)
        except StaleEditError:
            raise
        except (MosegError, OSError) as error:
            self._report(error)
            raise

    def _show(self, shown: ShownResult, **changes: Any) -> None:
        self._states[shown.key] = shown
        while len(self._states) > NUM_KEPT:
            del self._states[next(iter(self._states))]
        history = self._history
        self._change(
            shown=shown,
            corrections=history.current,
            can_undo=history.can_undo,
            can_redo=history.can_redo,
            **changes,
        )

    def _change(self, **changes: Any) -> None:
        now = self._moment
        self._moment = Moment(**{**_fields(now), "revision": now.revision + 1, **changes})
        self._publish()

    def _publish(self) -> None:
        self.events.send("state", {"revision": self._moment.revision, "phase": self._moment.phase})

    def _observe(self, what: str, totals: Mapping[str, int], done: Mapping[str, int]) -> None:
        """Send progress to the pages; ends the work if the server ends."""
        self._worker.check()
        now = time.monotonic()
        num_done, total = sum(done.values()), sum(totals.values())
        if not num_done:
            self._began = now
        if num_done and now - self._observed < MIN_PROGRESS_SECONDS and num_done < total:
            return
        self._observed = now
        stage = next((name for name in totals if done[name] < totals[name]), next(iter(totals)))
        left = round((now - self._began) / num_done * (total - num_done)) if num_done else None
        progress = {"what": what, "stage": stage, "done": num_done, "total": total, "secondsLeft": left}
        self.events.send("progress", progress)

    def _report(self, error: BaseException) -> None:
        print(f"moseg: {in_words(error)}", file=sys.stderr, flush=True)


def in_words(error: BaseException) -> str:
    """Return the line for an error."""
    if isinstance(error, MosegError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.strerror or error}"
    return f"a fault, not your input: {type(error).__name__}: {error}"


def _fields(moment: Moment) -> dict[str, Any]:
    return {name: getattr(moment, name) for name in moment.__dataclass_fields__}
