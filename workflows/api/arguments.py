"""Whether an argument is of the kind and within the limits that it takes, said before any work and by its own name."""

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

MOST_NAME_BYTES = 200
"""Of a name in UTF-8: files are called after it, with a suffix."""
_OPTION = re.compile(
    r"(?<![^\s(])--(batch|dataset|depth|device|dilate|flow|format|geometry|list|motions|name|non-commercial|offline|out"
    r"|overlay-size"
    r"|predictions|preset|proposals|quality|report|root|scheduler|seed|seeds|sequences|store|threads|tls-ca|tls-cert"
    r"|tls-key|tracks|variant|views|workers)(?![\w-])(?: folder:)?"
)
"""Options of the command line that are arguments here."""
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
    """Raise InputError where an argument is not of the kind, nor None where that is allowed."""
    types, expected = kind.value
    for name, value in arguments.items():
        if value is None and optional:
            continue
        # True is a whole number to Python alone.
        if not isinstance(value, types) or (isinstance(value, bool) and kind is not Kind.SWITCH):
            expected = f"{expected} or None" if optional else expected
            raise InputError("wrong kind of argument", where=name, got=_told(value), expected=expected)


def check_least(least: int, **arguments: int) -> None:
    """Raise InputError where an argument is no whole number of `least` or more."""
    check_kinds(Kind.COUNT, **arguments)
    for name, value in arguments.items():
        if value < least:
            raise InputError("not a number", where=name, got=value, expected=f"{least} or more")


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
    if not name.strip() or len(encoded) > MOST_NAME_BYTES or re.search(r"[/\x00-\x1f\x7f\ud800-\udfff]", name):
        expected = f"up to {MOST_NAME_BYTES} bytes of text, without '/' and line breaks, for files are called after it"
        raise InputError("not a name", where="name", got=_told(name), expected=expected)


def check_style(style: OverlayStyle | None) -> None:
    """Raise InputError where it is none."""
    if style is not None and not isinstance(style, OverlayStyle):
        expected = "a moseg.OverlayStyle or None"
        raise InputError("not a style", where="style", got=_told(style), expected=expected)


def read_names(name: str, value: Iterable[str]) -> tuple[str, ...]:
    """The names in an argument, where one may stand for itself; raises InputError where they are none."""
    if isinstance(value, str):
        return (value,)
    names = tuple(value) if isinstance(value, Iterable) else None
    if names is None or not all(isinstance(each, str) for each in names):
        raise InputError("wrong kind of argument", where=name, got=_told(value), expected="a name, or some in a list")
    return names


@contextmanager
def named_as_arguments() -> Iterator[None]:
    """Errors of the block that name an option of the command line name the argument."""
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
    return _OPTION.sub(_argument_of, text.replace("--set or --config", "config"))


def _argument_of(found: re.Match[str]) -> str:
    """The argument of an option; ``--depth folder:PATH`` is ``depth=PATH``."""
    name = _ARGUMENT_OF.get(found[1], found[1].replace("-", "_"))
    return f"{name}=" if found[0].endswith(" folder:") else name


def _told(value: object) -> str:
    text = repr(value)
    return f"{text} ({type(value).__name__})" if len(text) <= 60 else type(value).__name__
