"""What a task's adapter reads, out of memory instead of a store."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

Artifact = tuple[Mapping[str, np.ndarray], Mapping[str, Any]]
"""Arrays and attributes of one result."""


class MemoryView:
    """An artifact in memory, with the interface of `moseg.workflows.stages.inputs.ArtifactView`."""

    def __init__(self, artifact: Artifact):
        self._arrays, self._attributes = artifact

    def array(self, name: str) -> np.ndarray:
        """The whole array."""
        return self._arrays[name]

    cached = array

    def rows(self, name: str, start: int, stop: int) -> np.ndarray:
        """Rows start..stop of the leading axis."""
        return self._arrays[name][start:stop]

    def row_reader(self, name: str) -> Callable[[int], np.ndarray]:
        """A function from an index to that row of the leading axis."""
        return self._arrays[name].__getitem__

    def shape(self, name: str) -> tuple[int, ...]:
        """Shape of an array."""
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
        """The artifacts of a role that lists several."""
        return [MemoryView(artifact) for artifact in self._inputs[role]]
