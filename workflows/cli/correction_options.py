"""Options of `moseg segment` that correct its result."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from moseg.schemas.errors import InputError

if TYPE_CHECKING:
    from moseg.workflows.api.given_corrections import GivenCorrections


@dataclass(frozen=True)
class CorrectionOptions:
    """Corrections of the objects of an earlier result: a file, and more of them after it."""

    PANEL: ClassVar[str] = "Corrections"

    corrections: Annotated[
        str | None,
        typer.Option(
            "--corrections",
            help="YAML file of corrections, as `moseg view` and this command write it (OUT/corrections.yaml).",
            metavar="FILE",
        ),
    ] = None
    split: Annotated[
        list[str] | None,
        typer.Option(
            "--split",
            help="From a frame on, an object is another one (2@31), of this number (2@31:7) or the next free one; may"
            " be repeated, as all options below.",
            metavar="OBJECT@FRAME",
        ),
    ] = None
    rename: Annotated[
        list[str] | None, typer.Option("--rename", help="Name of an object (2=bear).", metavar="OBJECT=NAME")
    ] = None
    merge: Annotated[
        list[str] | None,
        typer.Option("--merge", help="Objects that are one, with the first one's number (3,4).", metavar="OBJECTS"),
    ] = None
    static: Annotated[
        list[str] | None, typer.Option("--static", help="Objects that belong to the background.", metavar="OBJECTS")
    ] = None
    moving: Annotated[
        list[str] | None, typer.Option("--moving", help="Objects that move on their own.", metavar="OBJECTS")
    ] = None
    keep: Annotated[
        list[str] | None,
        typer.Option("--keep", help="Objects that stay in the result whatever the settings say.", metavar="OBJECTS"),
    ] = None
    drop: Annotated[
        list[str] | None, typer.Option("--drop", help="Objects that are left out of the result.", metavar="OBJECTS")
    ] = None

    @property
    def given(self) -> tuple[str, ...]:
        """The options that were given."""
        return tuple(f"--{name}" for name, value in vars(self).items() if value)

    def read(self) -> "GivenCorrections":
        """Return the corrections: those of the file, then those of the options in the order of this class.

        Raises
        ------
        InputError
            The file or an option cannot be read as corrections.
        """
        from moseg.workflows.api.given_corrections import give_corrections
        from moseg.workflows.config.corrections_file import read_edit

        more = []
        for option, text, value in self._edits():
            more.append((f"{option} {text}", read_edit(value, f"{option} {text}")))
        return give_corrections(self.corrections, "--corrections", more)

    def _edits(self) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Yield the option, its text and the mapping of every edit."""
        for text in self.split or ():
            yield "--split", text, {"split": _read_split(text)}
        for text in self.rename or ():
            number, name = _cut(text, "=", "--rename", "OBJECT=NAME, such as 2=bear")
            identity = _number("--rename", number, text, "OBJECT=NAME, such as 2=bear")
            yield "--rename", text, {"rename": {"object": identity, "name": name}}
        for text in self.merge or ():
            yield "--merge", text, {"merge": _read_numbers("--merge", text)}
        for verdict in ("static", "moving", "keep", "drop"):
            for text in getattr(self, verdict) or ():
                for number in _read_numbers(f"--{verdict}", text):
                    yield f"--{verdict}", text, {verdict: number}


def _read_split(text: str) -> dict[str, int]:
    form = "OBJECT@FRAME, such as 2@31, or 2@31:7"
    number, place = _cut(text, "@", "--split", form)
    frame, colon, into = place.partition(":")
    parts = {"object": number, "frame": frame, **({"into": into} if colon else {})}
    return {name: _number("--split", part, text, form) for name, part in parts.items()}


def _read_numbers(option: str, text: str) -> list[int]:
    return [_number(option, part, text) for part in text.split(",")]


def _cut(text: str, sign: str, option: str, expected: str) -> tuple[str, str]:
    before, found, after = text.partition(sign)
    if not found:
        raise InputError("not a correction", where=option, got=text, expected=expected)
    return before, after


def _number(option: str, part: str, text: str, expected: str = "numbers of objects, separated by commas") -> int:
    if not part.strip().isascii() or not part.strip().isdigit():
        raise InputError("not a correction", where=option, got=text, expected=expected)
    return int(part)
