"""Checkpoint of a training: from it the same training goes on to the same result."""

import json
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

from moseg.schemas.errors import InputError
from moseg.workflows.process.atomic_write import atomic_path, blame_output
from moseg.workflows.sources.files import unreadable

FILE = "checkpoint.pt"


class Checkpoint(NamedTuple):
    """What a training has reached.

    Attributes
    ----------
    learner : dict
        State of the `Learner`.
    curve : list of dict
        Entries of the curve.
    losses : list of float
        Losses of the steps after the curve's last entry.
    """

    learner: dict[str, Any]
    curve: list[dict[str, float | None]]
    losses: list[float]

    def write(self, folder: Path, settings: dict[str, Any]) -> None:
        """Replace the checkpoint in a folder; raises InputError if it cannot be written."""
        import torch

        path = folder / FILE
        with atomic_path(path) as temporary, blame_output(path, RuntimeError), open(temporary, "wb") as file:
            torch.save({"settings": json.dumps(settings), **self._asdict()}, file)


def read_checkpoint(folder: Path, settings: dict[str, Any]) -> Checkpoint | None:
    """Return the checkpoint in a folder, or None if there is none.

    Raises
    ------
    InputError
        It cannot be read, or is that of a training with other settings.
    """
    import torch

    path = folder / FILE
    if not path.exists():
        return None
    try:
        content = path.read_bytes()
    except OSError as error:
        raise unreadable(str(path), error) from error
    try:
        read = torch.load(BytesIO(content), map_location="cpu", weights_only=True)
        own = json.loads(read.pop("settings"))
        checkpoint = Checkpoint(**read)
    # A damaged or foreign file raises errors without a common class: of pickle, zip and torch, and built-in ones.
    except Exception as error:
        expected = "that of a training; delete it to start anew"
        got = "a damaged file or one of another format"
        raise InputError("not a checkpoint", where=path, got=got, expected=expected) from error
    if own != settings:
        changed = sorted(name for name in {*own, *settings} if own.get(name) != settings.get(name))
        got = ", ".join(f"{name} {own.get(name)}" for name in changed)
        asked = ", ".join(f"{name} {settings.get(name)}" for name in changed)
        expected = f"{asked}; choose another --folder, or delete the file to start anew"
        raise InputError("the checkpoint of another training", where=path, got=got, expected=expected)
    return checkpoint
