"""Inputs of a recipe, which a task's adapter reads from the store on demand."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Recipe
from moseg.workflows.stages.array_cache import ARRAYS

ROWS_PER_READ = 16


class ReadableStore(Protocol):
    """Part of an artifact store that tasks use; see `store.ArtifactStore`."""

    url: str

    def manifest(self, ref: str) -> Manifest: ...

    def attributes(self, ref: str) -> dict: ...

    def read(self, ref: str, name: str) -> np.ndarray: ...

    def read_rows(self, ref: str, name: str, start: int, stop: int) -> np.ndarray: ...


class ArtifactView:
    """View of one stored artifact, whose arrays are read on demand."""

    def __init__(self, store: ReadableStore, ref: str):
        self._store = store
        self._ref = ref

    @property
    def ref(self) -> str:
        """Reference of the artifact."""
        return self._ref

    def array(self, name: str) -> np.ndarray:
        """Return the whole array; read-only if this process has cached it."""
        kept = ARRAYS.find(self._store.url, self._ref, name)
        return self._store.read(self._ref, name) if kept is None else kept

    def cached(self, name: str) -> np.ndarray:
        """Return the whole array, read-only, and cache it in this process for the next task that reads it."""
        array = self.array(name)
        array.flags.writeable = False
        ARRAYS.keep(self._store.url, self._ref, {name: array})
        return array

    def derived(self, name: str, variant: str, derive: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Return what `derive` makes of an array, read-only, and cache it in this process.

        `variant` names the result among those of the array: it says all that the result depends on beside it.
        """
        entry = f"{name} {variant}"
        kept = ARRAYS.find(self._store.url, self._ref, entry)
        if kept is None:
            kept = derive(self.cached(name))
            kept.flags.writeable = False
            ARRAYS.keep(self._store.url, self._ref, {entry: kept})
        return kept

    def find_kept(self, name: str) -> np.ndarray | None:
        """Return what `keep` kept in this process, read-only; None if it is not there or no longer."""
        return ARRAYS.find(self._store.url, self._ref, f"kept: {name}")

    def keep(self, name: str, array: np.ndarray) -> None:
        """Cache an array that follows from this artifact alone, for the next task of this process that needs it.

        It saves time if the next task runs in the same process; a task must compute the same array otherwise.
        """
        ARRAYS.keep(self._store.url, self._ref, {f"kept: {name}": array})

    def rows(self, name: str, start: int, stop: int) -> np.ndarray:
        """Return rows start..stop of the leading axis, reading only their chunks; read-only if the array is cached."""
        kept = ARRAYS.find(self._store.url, self._ref, name)
        if kept is None or not 0 <= start <= stop <= len(kept):
            return self._store.read_rows(self._ref, name, start, stop)
        return kept[start:stop]

    def row_reader(self, name: str) -> Callable[[int], np.ndarray]:
        """Return a function from an index to a row of the leading axis; it reads and keeps one block at a time."""
        length = self.shape(name)[0]
        block, start = None, -1

        def row(index: int) -> np.ndarray:
            nonlocal block, start
            if block is None or not start <= index < start + len(block):
                start = index - index % ROWS_PER_READ
                block = self.rows(name, start, min(start + ROWS_PER_READ, length))
            return block[index - start]

        return row

    def shape(self, name: str) -> tuple[int, ...]:
        """Return the shape of an array without reading it."""
        kept = ARRAYS.find(self._store.url, self._ref, name)
        if kept is not None:
            return kept.shape
        return self._store.manifest(self._ref).array(name).shape

    @property
    def attributes(self) -> dict:
        """Small results that are not arrays."""
        return dict(self._store.attributes(self._ref))


class Inputs:
    """Inputs of one recipe by role."""

    def __init__(self, store: ReadableStore, recipe: Recipe):
        self._store = store
        self._inputs = recipe.inputs

    def __contains__(self, role: str) -> bool:
        return role in self._inputs

    def __getitem__(self, role: str) -> ArtifactView:
        """Return the artifact of a role that has exactly one."""
        ref = self._inputs[role]
        if not isinstance(ref, str):
            raise TypeError(f"role {role!r} lists several inputs")
        return ArtifactView(self._store, ref)

    def all(self, role: str) -> list[ArtifactView]:
        """Return the artifacts of a role that lists several."""
        return [ArtifactView(self._store, ref) for ref in self._inputs[role]]
