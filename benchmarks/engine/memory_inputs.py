"""Inputs of a task's adapter, from memory instead of a store."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from moseg.schemas.digests import hash_array

Artifact = tuple[Mapping[str, np.ndarray], Mapping[str, Any]]
"""Arrays and attributes of one result."""


class MemoryView:
    """Artifact in memory, with the interface of `moseg.workflows.stages.inputs.ArtifactView`.

    It keeps nothing for other tasks: what several tasks derive from an array is computed by each.
    """

    def __init__(self, artifact: Artifact):
        self._arrays, self._attributes = artifact

    @property
    def ref(self) -> str:
        """Name of the artifact that follows from its arrays, which are digested."""
        return "/".join(hash_array(self._arrays[name]) for name in sorted(self._arrays))

    def array(self, name: str) -> np.ndarray:
        """Return the whole array."""
        return self._arrays[name]

    cached = array

    def derived(self, name: str, variant: str, derive: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Return what `derive` makes of an array."""
        return derive(self._arrays[name])

    def find_kept(self, name: str) -> None:
        """Return None: no task keeps anything for the next."""

    def keep(self, name: str, array: np.ndarray) -> None:
        """Keep nothing."""

    def rows(self, name: str, start: int, stop: int) -> np.ndarray:
        """Return rows start..stop of the leading axis."""
        return self._arrays[name][start:stop]

    def row_reader(self, name: str) -> Callable[[int], np.ndarray]:
        """Return a function from an index to that row of the leading axis."""
        return self._arrays[name].__getitem__

    def shape(self, name: str) -> tuple[int, ...]:
        """Return the shape of an array."""
        return self._arrays[name].shape

    @property
    def attributes(self) -> dict:
        """Small results that are not arrays."""
        return dict(self._attributes)


class MemoryInputs:
    """Inputs of a task in memory, with the interface of `moseg.workflows.stages.inputs.Inputs`."""

    def __init__(self, inputs: Mapping[str, Artifact | list[Artifact]]):
        self._inputs = inputs

    def __contains__(self, role: str) -> bool:
        return role in self._inputs

    def __getitem__(self, role: str) -> MemoryView:
        return MemoryView(self._inputs[role])

    def all(self, role: str) -> list[MemoryView]:
        """Return the artifacts of a role that lists several."""
        return [MemoryView(artifact) for artifact in self._inputs[role]]
