"""Lineage: the ancestors and the descendants of an artifact.

Every recipe names its inputs, so ancestors are found by a walk from manifest to manifest. No artifact names its
descendants: they are found by one pass over the manifests of the whole store.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import StrEnum
from typing import NamedTuple

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.schemas.recipes import Recipe
from moseg.store.ahead import map_reads
from moseg.store.protocol import ArtifactStore


class State(StrEnum):
    """State of a relative in the store."""

    STORED = "stored"
    ABSENT = "absent"
    """Never copied here, or removed: its own inputs are not known."""
    DAMAGED = "damaged"
    """Its manifest differs from the one that was committed: its own inputs are not known."""


class Relative(NamedTuple):
    """An ancestor or a descendant of an artifact, and data of its manifest.

    Attributes
    ----------
    depth : int
        Length of the shortest path between the two: 1 for an input, 0 for the artifact itself.
    recipe : Recipe or None
        None unless it is stored.
    nbytes : int
        Bytes of its files but the manifest; 0 unless it is stored.
    problem : str or None
        Why there is no recipe.
    """

    ref: str
    depth: int
    state: State
    recipe: Recipe | None = None
    nbytes: int = 0
    problem: str | None = None

    def input_refs(self) -> tuple[str, ...]:
        """Return each input once; none if the recipe is not known."""
        return () if self.recipe is None else tuple(dict.fromkeys(self.recipe.input_refs()))


def ancestry(store: ArtifactStore, refs: Iterable[str]) -> Iterator[Relative]:
    """Iterate over the artifacts and their ancestors, the nearest first.

    The walk ends at artifacts that are absent or damaged.
    """
    level, depth = list(dict.fromkeys(refs)), 0
    seen = set(level)
    while level:
        following: dict[str, None] = {}
        for relative in read_recipes(store, level, depth):
            yield relative
            following |= dict.fromkeys(ref for ref in relative.input_refs() if ref not in seen)
        seen |= following.keys()
        level, depth = list(following), depth + 1


def descendants(
    store: ArtifactStore, ref: str, refs: Iterable[str] | None = None, on_read: Callable[[], None] | None = None
) -> Iterator[Relative]:
    """Iterate over the stored artifacts that were computed from one, directly or indirectly, the nearest first.

    Reads the manifest of every artifact, or of `refs`, once and calls `on_read` after each. Damaged descendants, and
    those connected only through an artifact that is gone, are not found.
    """
    children: dict[str, list[str]] = {}
    for relative in read_recipes(store, store.refs() if refs is None else refs):
        for parent in relative.input_refs():
            children.setdefault(parent, []).append(relative.ref)
        if on_read is not None:
            on_read()
    for depth, level in enumerate(_levels(ref, children), start=1):
        yield from read_recipes(store, level, depth)


def read_recipes(store: ArtifactStore, refs: Iterable[str], depth: int = 0) -> Iterator[Relative]:
    """Read the recipe of each artifact, in order; concurrently from a store behind a network."""

    def read(ref: str) -> Relative:
        try:
            manifest = store.manifest(ref)
        except MissingArtifactError as error:
            return Relative(ref, depth, State.ABSENT, problem=str(error))
        except CorruptArtifactError as error:
            return Relative(ref, depth, State.DAMAGED, problem=str(error))
        return Relative(ref, depth, State.STORED, manifest.recipe, manifest.nbytes)

    return map_reads(store, read, refs)


def _levels(ref: str, children: Mapping[str, list[str]]) -> Iterator[list[str]]:
    """Iterate over the descendants at distance 1, 2 and so on; each artifact is in its first level only."""
    seen, level = {ref}, [ref]
    while level:
        found = dict.fromkeys(child for parent in level for child in children.get(parent, ()))
        level = [child for child in found if child not in seen]
        seen.update(level)
        if level:
            yield level
