"""Names that a parameter of type `ChoiceOf` accepts.

The names are declared in packages that `moseg.schemas` does not import. The package `moseg`, which is imported before
all of them, sets the function that finds the names; it is called when a value is checked or listed.
"""

from collections.abc import Callable, Iterable

_find: list[Callable[[str], Iterable[str]]] = []


def find_names_by(find: Callable[[str], Iterable[str]]) -> None:
    """Set the function that returns the names declared for a parameter, given as ``stage.name``."""
    _find[:] = [find]


def declared_names(parameter: str) -> tuple[str, ...]:
    """Return the names declared for a parameter, in the order of the declarations."""
    return tuple(_find[0](parameter))
