"""Which worker runs networks, and on which device: a GPU is a Dask resource, of which a call takes one."""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

GPU = "GPU"
"""Name of the resource; a worker of an existing cluster declares it by ``dask worker --resources GPU=1``."""


class Placement(NamedTuple):
    """A worker's device, and the resources that it gets in addition to those that it declares itself."""

    device: str
    resources: Mapping[str, int] = {}


class PlacementPolicy(Protocol):
    """A rule by which each worker of a cluster gets its device."""

    def place(self, name: Hashable, declared: Mapping[str, float]) -> Placement:
        """Return the placement of the worker `name`, which itself declares these resources."""


@dataclass(frozen=True)
class AssignedAccelerators:
    """A policy for local workers: an accelerator belongs to one worker, and the others compute on the CPU."""

    accelerators: Mapping[Hashable, str] = field(default_factory=dict)

    def place(self, name: Hashable, declared: Mapping[str, float]) -> Placement:
        """See `PlacementPolicy.place`."""
        if name in self.accelerators:
            return Placement(self.accelerators[name], {GPU: 1})
        return Placement("cpu")


@dataclass(frozen=True)
class DeclaredGpus:
    """A policy for an existing cluster: workers that declare a GPU use it; a GPU that none declares stays unused."""

    device: str

    def place(self, name: Hashable, declared: Mapping[str, float]) -> Placement:
        """See `PlacementPolicy.place`."""
        return Placement(self.device if declared.get(GPU) else "cpu")
