"""Errors for names that are not known, with the name that was probably meant."""

import difflib
from collections.abc import Collection

from moseg.schemas.errors import InputError

MOST_SHOWN = 12
"""Known names printed before the rest is only counted: an error is one line."""


def closest(name: str, known: Collection[str]) -> str | None:
    """The known name that `name` was probably meant to be; None where none is alike."""
    folded = {other.casefold(): other for other in known}
    close = difflib.get_close_matches(name.casefold(), folded, n=1)
    return folded[close[0]] if close else None


def unknown_name(
    kind: str, name: str, known: Collection[str], *, where: object = None, expected: str | None = None
) -> InputError:
    """The error for `name`, which is none of the `known` names of this kind.

    `where` is the option or file it stands in; `expected` says what is accepted instead of a list of what is known.
    """
    place = "" if where is None else f" in {where}"
    close = closest(name, known)
    if close is not None:
        return InputError(f"unknown {kind} {name!r}{place}: did you mean {close!r}?")
    if expected is None and known:
        shown = ", ".join(sorted(known)[:MOST_SHOWN])
        more = f" and {len(known) - MOST_SHOWN} more" if len(known) > MOST_SHOWN else ""
        expected = f"one of {shown}{more}"
    return InputError(f"unknown {kind}", where=where, got=repr(name), expected=expected)
