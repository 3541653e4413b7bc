"""Inputs of a task's adapter, from memory instead of a store."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

Artifact = tuple[Mapping[str, np.ndarray], Mapping[str, Any]]
"""Arrays and attributes of one result."""


class MemoryView:
    """Artifact in memory, with the interface of `moseg.workflows.stages.inputs.ArtifactView`."""

    def __init__(self, artifact: Artifact):
        self._arrays, self._attributes = artifact

    def array(self, name: str) -> np.ndarray:
        """Return the whole array."""
        return self._arrays[name]

    cached = array

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
