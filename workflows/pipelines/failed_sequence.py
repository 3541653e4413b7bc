"""The sequence in whose computation an error occurred."""

from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import contextmanager

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.workflows.runlog.events import written_refs


@contextmanager
def name_failed_sequence(recipes: Mapping[str, Recipe], sinks_of: Mapping[str, Sequence[str]]) -> Iterator[None]:
    """Add the name of its sequence to an InputError of the block that a stage raised; stages do not know the names.

    Where a network computed frames of several sequences at once, the error stays without a name.

    Parameters
    ----------
    recipes : mapping of reference to recipe
        Of all sequences; it may be filled within the block, as may `sinks_of`.
    sinks_of : mapping of str to sequence of references
        What is wanted of each sequence, by its name; it depends on all that is computed.
    """
    try:
        yield
    except InputError as error:
        refs = set(written_refs(error))
        name = next((name for name, sinks in sinks_of.items() if refs and _depend(sinks, refs, recipes)), None)
        if name is None:
            raise
        what, where, got, expected = error.parts
        place = f"sequence {name}" if where is None else f"{where}, sequence {name}"
        named = type(error)(what, where=place, got=got, expected=expected)
        for note in error.__notes__:
            named.add_note(note)
        raise named from error


def _depend(sinks: Sequence[str], refs: Set[str], recipes: Mapping[str, Recipe]) -> bool:
    """Return whether each of some artifacts is among the sinks or is needed by one of them."""
    waiting, seen = list(sinks), set()
    while waiting:
        each = waiting.pop()
        if each not in seen:
            seen.add(each)
            waiting.extend(recipes[each].input_refs() if each in recipes else ())
    return refs <= seen
