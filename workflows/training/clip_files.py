"""Files of clips: a folder for each video and everything that its clips are made from."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.process.atomic_write import atomic_path, blame_output

if TYPE_CHECKING:
    from moseg.tasks.network_training.clips import Clip

_COMPLETE = "complete.txt"


class ClipFolder:
    """The clips of a video.

    Parameters
    ----------
    folder : Path
        Of the training.
    made_from : dict
        What the clips depend on, as in JSON.
    """

    def __init__(self, folder: Path, made_from: dict[str, Any]):
        digest = digest_json("clips", made_from)
        self._folder = folder / "clips" / digest.rpartition(":")[2][:32]

    def is_complete(self) -> bool:
        """Return whether all clips have been written."""
        return (self._folder / _COMPLETE).exists()

    def write(self, number: int, clip: "Clip") -> None:
        """Write a clip; raises InputError if that fails."""
        path = self._folder / f"{number:04d}.npz"
        with atomic_path(path) as temporary, blame_output(path), open(temporary, "wb") as file:
            np.savez(file, **clip._asdict())

    def complete(self) -> None:
        """Note that all clips have been written; raises InputError if that fails."""
        write_text(self._folder / _COMPLETE, f"{len(self.paths())}\n")

    def paths(self) -> tuple[Path, ...]:
        """Return the files of the clips in order."""
        return tuple(sorted(self._folder.glob("*.npz")))


def read_clip(path: Path) -> "Clip":
    """Return the clip in a file."""
    from moseg.tasks.network_training.clips import Clip

    with np.load(path, allow_pickle=False) as arrays:
        return Clip(**arrays)
