"""An opened result, and the functions that correct and write it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

from moseg.schemas.corrections import Corrections
from moseg.workflows.view.shown_result import ShownResult


class ExportChoices(NamedTuple):
    """Outputs beside the masks, as the options of `moseg segment` of these names.

    Attributes
    ----------
    overlay, overlay_size : str
    side_by_side, identities : bool
    formats, sets : tuple of str
    every : str or None
    dilate : int or None
    """

    overlay: str = "outline"
    overlay_size: str = "analysed"
    side_by_side: bool = False
    identities: bool = False
    formats: tuple[str, ...] = ()
    sets: tuple[str, ...] = ()
    every: str | None = None
    dilate: int | None = None


class Written(NamedTuple):
    """Paths of what was written, and what is worth a look in the result."""

    paths: tuple[Path, ...]
    look_at: tuple[str, ...]


class Corrector(Protocol):
    """A result that stays open between corrections."""

    def __call__(self, corrections: Corrections) -> ShownResult:
        """Return the result under corrections; raises InputError where one names an object that is not there."""


@dataclass(frozen=True)
class Opened:
    """An open result.

    Attributes
    ----------
    first : ShownResult
        Without any correction.
    correct : Corrector
    write : function of what to write
        Writes the result of the corrections in force into the output folder.
    prepare : tuple of functions without arguments
        Steps, each short, that compute what the first change of a setting would wait for.
    repair : function of a reference
        Computes an artifact again that is damaged or missing.
    video : str or None
        Digest by which the video is known.
    part : str or None
        Which of its frames were read, if not all.
    has_video : bool
        Whether formats that contain the frames can be written.
    words : tuple of str
        Words of a command without corrections that gives the first result.
    growing : tuple of str
        Ways in which an object can grow from a click.
    look_at : tuple of str
        What is worth a look in the result that the output folder has, if it has one.
    """

    first: ShownResult
    correct: Corrector
    write: Callable[[ExportChoices], Written]
    prepare: tuple[Callable[[], None], ...]
    repair: Callable[[str], None]
    video: str | None
    part: str | None
    has_video: bool
    words: tuple[str, ...]
    growing: tuple[str, ...] = ()
    look_at: tuple[str, ...] = ()
