"""Checks of the kinds and limits of arguments, made before any work, with errors that name the argument."""

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from enum import Enum
from numbers import Integral, Real

import numpy as np

from moseg.schemas.errors import InputError, MosegError
from moseg.workflows.config import frame_rate
from moseg.workflows.exports import OverlayStyle

MAX_NAME_BYTES = 200
"""Of a name in UTF-8: files are called after it, with a suffix."""
_OPTION = re.compile(
    r"(?<![^\s(])--(batch|corrections|dataset|depth|device|dilate|end|every|flow|fps|format|geometry|light|list|motions|name"
    r"|accept-licence|non-commercial|offline|out|overlay-size"
    r"|predictions|preset|proposals|quality|report|root|scheduler|seed|seeds|sensitivity|sequences|start|store|threads|tls-ca"
    r"|tls-cert|tls-key|tracks|variant|views|workers)(?![\w-])(?: folder:)?"
)
"""Options of the command line that are arguments here."""
_SOURCE = re.compile(r"--proposals (?=[a-z])(?!folder:)")
"""The option with the name of a source: the argument is a folder, and a parameter chooses the source."""
_ARGUMENT_OF = {"dilate": "dilation", "list": "list_file", "out": "folder", "variant": "variants"}
"""The names of those that differ by more than dashes."""


class Kind(Enum):
    """What an argument takes: the types, and what messages call them."""

    PATH = (str, bytes, os.PathLike), "a path"
    TEXT = (str,), "text"
    NUMBER = (Real,), "a number"
    COUNT = (Integral,), "a whole number"
    TEXT_OR_COUNT = (str, Integral), "text or a whole number"
    SWITCH = (bool, np.bool_), "True or False"


def check_kinds(kind: Kind, *, optional: bool = False, **arguments: object) -> None:
    """Raise InputError unless an argument is of the kind, or None where that is allowed."""
    types, expected = kind.value
    for name, value in arguments.items():
        if value is None and optional:
            continue
        # True is a whole number to Python alone.
        if not isinstance(value, types) or (isinstance(value, bool) and kind is not Kind.SWITCH):
            expected = f"{expected} or None" if optional else expected
            raise InputError("wrong kind of argument", where=name, got=_describe(value), expected=expected)


def check_min(minimum: int, **arguments: int) -> None:
    """Raise InputError unless an argument is a whole number of `minimum` or more."""
    check_kinds(Kind.COUNT, **arguments)
    for name, value in arguments.items():
        if value < minimum:
            raise InputError("not a number", where=name, got=value, expected=f"{minimum} or more")


def check_fps(fps: float | None) -> None:
    """Raise InputError where frames cannot be shown at such a rate."""
    check_kinds(Kind.NUMBER, optional=True, fps=fps)
    if fps is not None:
        frame_rate.check_fps(fps, "fps")


def check_name(name: str | None) -> None:
    """Raise InputError where files cannot be called after a name."""
    check_kinds(Kind.TEXT, optional=True, name=name)
    if name is None:
        return
    encoded = name.encode("utf-8", "replace")
    if not name.strip() or len(encoded) > MAX_NAME_BYTES or re.search(r"[/\x00-\x1f\x7f\ud800-\udfff]", name):
        expected = f"up to {MAX_NAME_BYTES} bytes of text, without '/' and line breaks, for files are called after it"
        raise InputError("not a name", where="name", got=_describe(name), expected=expected)


def check_style(style: OverlayStyle | None) -> None:
    """Raise InputError unless it is an OverlayStyle or None."""
    if style is not None and not isinstance(style, OverlayStyle):
        expected = "a moseg.OverlayStyle or None"
        raise InputError("not a style", where="style", got=_describe(style), expected=expected)


def read_names(name: str, value: Iterable[str]) -> tuple[str, ...]:
    """Return the names in an argument, which may be a single one; raises InputError where they are not names."""
    if isinstance(value, str):
        return (value,)
    names = tuple(value) if isinstance(value, Iterable) else None
    if names is None or not all(isinstance(each, str) for each in names):
        raise InputError(
            "wrong kind of argument", where=name, got=_describe(value), expected="a name, or some in a list"
        )
    return names


@contextmanager
def named_as_arguments() -> Iterator[None]:
    """Make errors of the block that name an option of the command line name the argument."""
    try:
        yield
    except MosegError as error:
        what, where, got, expected = error.parts
        is_option = isinstance(where, str) and where.startswith("--")
        parts = (_renamed(what), *((_renamed(where), _renamed(got)) if is_option else (where, got)), _renamed(expected))
        if parts == error.parts:
            raise
        what, where, got, expected = parts
        renamed = type(error)(what, where=where, got=got, expected=expected)
        raise renamed.with_traceback(error.__traceback__) from error.__cause__


def _renamed(text: object) -> object:
    if not isinstance(text, str):
        return text
    return _OPTION.sub(_argument_of, _SOURCE.sub("proposal_source=", text.replace("--set or --config", "config")))


def _argument_of(found: re.Match[str]) -> str:
    """Return the argument of an option; ``--depth folder:PATH`` is ``depth=PATH``."""
    name = _ARGUMENT_OF.get(found[1], found[1].replace("-", "_"))
    return f"{name}=" if found[0].endswith(" folder:") else name


def _describe(value: object) -> str:
    text = repr(value)
    return f"{text} ({type(value).__name__})" if len(text) <= 60 else type(value).__name__
