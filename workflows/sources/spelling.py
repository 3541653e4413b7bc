"""Errors for names that are not known, with the name that was probably meant."""

import difflib
from collections.abc import Collection

from schemas.errors import InputError

MOST_SHOWN = 12
"""Known names printed before the rest is only counted: an error is one line."""


def unknown_name(kind: str, name: str, known: Collection[str]) -> InputError:
    """The error for `name`, which is none of the `known` names of this kind."""
    folded = {other.casefold(): other for other in known}
    close = difflib.get_close_matches(name.casefold(), folded, n=1)
    if close:
        return InputError(f"unknown {kind} {name!r}: did you mean {folded[close[0]]!r}?")
    shown = ", ".join(sorted(known)[:MOST_SHOWN])
    more = f" and {len(known) - MOST_SHOWN} more" if len(known) > MOST_SHOWN else ""
    return InputError(f"unknown {kind}", got=repr(name), expected=f"one of {shown}{more}" if known else None)
