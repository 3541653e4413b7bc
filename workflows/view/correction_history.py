"""The corrections in force, their file, and the states before and after them for undo and redo."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import InputError
from moseg.workflows.api.given_corrections import CORRECTIONS
from moseg.workflows.config.corrections_file import read_corrections, read_edit, spell_corrections
from moseg.workflows.exports import write_text
from moseg.workflows.process.atomic_write import blame_output


class StaleEditError(InputError):
    """A change of something that has changed meanwhile."""


class CorrectionHistory:
    """States of the corrections of one result, one of them in force and in the file.

    The file alone counts: a server that begins anew finds the corrections in it, and undoes them one by one from the
    last.

    Parameters
    ----------
    folder : Path
        Output folder, which has the file if there are corrections.
    video : str or None
        Digest of the video: the file says what it corrects.
    part : str, optional
        Which of its frames, if not all.

    Raises
    ------
    InputError
        The file does not hold corrections, or those of another video.
    """

    def __init__(self, folder: Path, video: str | None = None, part: str | None = None):
        self.path = Path(folder) / CORRECTIONS
        self._video, self._part = video, part
        self._gesture: object = None
        self._text = ""
        self._states: list[Corrections] = []
        self._place = 0
        self.reload()

    @property
    def current(self) -> Corrections:
        """The corrections in force."""
        return self._states[self._place]

    @property
    def can_undo(self) -> bool:
        """True if there is a state before."""
        return self._place > 0

    @property
    def can_redo(self) -> bool:
        """True if there is a state after."""
        return self._place + 1 < len(self._states)

    def is_stale(self) -> bool:
        """Return whether the file is not what was last read or written: someone else has changed it."""
        return self._read_text() != self._text

    def reload(self, enforce: Callable[[Corrections], object] = lambda corrections: None) -> None:
        """Take the corrections from the file; undo then removes them from the last one to the first.

        `enforce` is called with them first; if it raises, the history stays as it is.
        """
        text = self._read_text()
        found = read_corrections(str(self.path)) if text else Corrections()
        if None not in (found.video, self._video) and found.video != self._video:
            expected = "those of this video, or another --out"
            raise InputError("corrections of another video", where=self.path, got=found.video, expected=expected)
        found = found.model_copy(update={"video": self._video or found.video, "part": self._part or found.part})
        first = found.model_copy(update={"edits": (), "settings": {}})
        states = [first]
        if found.settings:
            states.append(first.model_copy(update={"settings": found.settings}))
        states += [
            states[-1].model_copy(update={"edits": found.edits[: number + 1]}) for number in range(len(found.edits))
        ]
        enforce(states[-1])
        self._states, self._place, self._gesture, self._text = states, len(states) - 1, None, text

    def with_edit(self, edit: Any) -> Corrections:
        """Return the corrections in force with one more edit, as JSON has it; raises InputError if it is none."""
        return self.current.extended([read_edit(edit, "the edit")])

    def with_setting(self, name: str, value: Any) -> Corrections:
        """Return the corrections in force with another value of a parameter, the run's own where None."""
        settings = {key: each for key, each in self.current.settings.items() if key != name}
        if value is not None:
            settings |= read_corrections({"settings": {name: value}}, "the settings").settings
        return self.current.model_copy(update={"settings": settings})

    def before(self) -> Corrections:
        """Return the state before; raises InputError if there is none."""
        if not self.can_undo:
            raise InputError("nothing to undo")
        return self._states[self._place - 1]

    def after(self) -> Corrections:
        """Return the state after; raises InputError if there is none."""
        if not self.can_redo:
            raise InputError("nothing to redo")
        return self._states[self._place + 1]

    def put(self, corrections: Corrections, gesture: object = None) -> None:
        """Write corrections, then have them in force.

        Parameters
        ----------
        gesture : object, optional
            What a change belongs to: later changes of one gesture, such as a slider that moves, replace each other.

        Raises
        ------
        InputError
            The file cannot be written; what was in force stays so, here and in the file.
        """
        self._write(corrections)
        is_same = gesture is not None and gesture == self._gesture and self._place > 0
        kept = self._states[: self._place if is_same else self._place + 1]
        self._states, self._place, self._gesture = [*kept, corrections], len(kept), gesture

    def step(self, by: int) -> None:
        """Write the state before, -1, or after, +1, then have it in force; raises InputError as `put`."""
        self._write(self._states[self._place + by])
        self._place += by
        self._gesture = None

    def _write(self, corrections: Corrections) -> None:
        text = spell_corrections(corrections) if corrections else ""
        if text:
            write_text(self.path, text)
        else:
            # Without corrections there is no file, as `moseg segment` leaves none.
            with blame_output(self.path):
                self.path.unlink(missing_ok=True)
        self._text = text

    def _read_text(self) -> str:
        try:
            return self.path.read_text(encoding="utf-8", errors="surrogateescape")
        except FileNotFoundError:
            return ""
        except OSError as error:
            got = error.strerror
            raise InputError("a file that cannot be read", where=os.fspath(self.path), got=got) from error
