"""Leaves of weights items by name, each of which is found when a graph first reads it."""

from collections.abc import Callable, Iterator, Mapping

from moseg.schemas.digests import digest_json
from moseg.schemas.recipes import leaf_recipe


class LeavesByName(Mapping[str, str]):
    """References of weights items' leaves.

    A configuration may name a network that no node of the graph runs, for example cameras for moving regions that do
    not come from tracks. To find a leaf can mean a download, so it is found when a node asks for it.

    Parameters
    ----------
    items : mapping of str to str
        Architecture that each item must have, by name.
    find : function
        Returns the reference of an item's leaf from its name and architecture.
    """

    def __init__(self, items: Mapping[str, str], find: Callable[[str, str], str]):
        self._items = items
        self._find = find
        self._found: dict[str, str] = {}

    @property
    def read(self) -> tuple[str, ...]:
        """Names of the items that were asked for, in this order."""
        return tuple(self._found)

    def recorded(self) -> dict[str, str]:
        """Return the leaves that were found, and for the other items references that no artifact has.

        With these a graph can be written again, without any weights, to look up its artifacts.
        """
        return {name: self._found.get(name, absent_leaf(name)) for name in self._items}

    def __or__(self, other: "LeavesByName") -> "LeavesByName":
        """Return the leaves of the items of both, which are found in the same way."""
        both = LeavesByName({**self._items, **other._items}, self._find)
        both._found = {**self._found, **other._found}
        return both

    def __getitem__(self, name: str) -> str:
        if name not in self._found:
            self._found[name] = self._find(name, self._items[name])
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __eq__(self, other: object) -> bool:
        """Return whether the items are the same, and the leaves of those that either graph has read."""
        if not isinstance(other, LeavesByName):
            return NotImplemented
        return self._items == other._items and all(self[name] == other[name] for name in {*self.read, *other.read})

    __hash__ = None


def absent_leaf(name: str) -> str:
    """Return a reference for an item whose leaf is not known: no artifact has it."""
    return leaf_recipe("weights", digest_json("absent", name)).ref
