"""Errors for unknown names, with the most similar known name."""

import difflib
from collections.abc import Collection

from moseg.schemas.errors import InputError

MAX_SHOWN = 12
"""Known names shown at most, because an error is one line; the others are only counted."""


def closest(name: str, known: Collection[str]) -> str | None:
    """Return the known name that is most similar to `name`; None if none is similar."""
    folded = {other.casefold(): other for other in known}
    close = difflib.get_close_matches(name.casefold(), folded, n=1)
    return folded[close[0]] if close else None


def unknown_name(
    kind: str, name: str, known: Collection[str], *, where: object = None, expected: str | None = None
) -> InputError:
    """Return the error for `name`, which is not among the `known` names of this kind.

    `where` is the option or file that contains it; `expected` replaces the list of known names.
    """
    place = "" if where is None else f" in {where}"
    close = closest(name, known)
    if close is not None:
        return InputError(f"unknown {kind} {name!r}{place}: did you mean {close!r}?")
    if expected is None and known:
        shown = ", ".join(sorted(known)[:MAX_SHOWN])
        more = f" and {len(known) - MAX_SHOWN} more" if len(known) > MAX_SHOWN else ""
        expected = f"one of {shown}{more}"
    return InputError(f"unknown {kind}", where=where, got=repr(name), expected=expected)
