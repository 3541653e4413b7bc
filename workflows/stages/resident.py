"""The network that a process keeps: loaded for the first task that runs it, released for a task that runs another."""

import gc
import os
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from moseg.workflows.process.devices import current_device, network_context
from moseg.workflows.stages.inputs import ArtifactView

Network = TypeVar("Network")

_RESIDENT: list[tuple[tuple[str, str, str], object]] = []
_IN_USE = threading.RLock()
"""Lock for the workers of other clusters, which may have several threads that share the network."""


@contextmanager
def open_network(build: Callable[..., Network], weights: ArtifactView) -> Iterator[Network]:
    """Open the network that `build` makes of a checkpoint, on this process's device and ready to run.

    Parameters
    ----------
    build : function of a `moseg.tasks.networks.Checkpoint`
    weights : ArtifactView
        The leaf that names the weights item and the digest of each of its files.

    Raises
    ------
    InputError
        A file of the item is missing here, is not the one whose digest the leaf names, or does not fit the network.
    """
    device = current_device()
    wanted = (weights.ref, f"{build.__module__}.{build.__qualname__}", str(device))
    with _IN_USE:
        if not _RESIDENT or _RESIDENT[0][0] != wanted:
            # First, because the memory may not hold two networks.
            _release()
            _RESIDENT.append((wanted, _load(build, weights).to(device)))
        with network_context(device):
            yield _RESIDENT[0][1]


def _release() -> None:
    """Free the memory of the network that is kept, if there is one."""
    tensors = [tensor for _, network in _RESIDENT for tensor in _weak_tensors(network)]
    _RESIDENT.clear()
    # Only objects that refer to each other remain; to search for these takes a quarter of a second.
    if any(tensor() is not None for tensor in tensors):
        gc.collect()


def _weak_tensors(network: object) -> list[weakref.ref]:
    """Return weak references to the tensors of a network, or of the networks in a tuple."""
    parts = network if isinstance(network, tuple) else (network,)
    modules = [part for part in parts if hasattr(part, "parameters")]
    return [weakref.ref(tensor) for module in modules for tensor in module.parameters()]


def _load(build: Callable[..., Network], weights: ArtifactView) -> Network:
    # Here, because the items of the catalogue are checked against the networks that the stages declare.
    from moseg.workflows.weights.folder import open_weights

    leaf = weights.attributes
    # The weights were fetched before the tasks started; a worker never downloads.
    folder = open_weights(os.environ, offline=True, check_licences=False)
    item = folder.item(leaf["item"]).model_copy(update={"config": leaf["config"]})
    return build(folder.read(item, leaf["files"]))


def made_on() -> dict[str, str]:
    """Return the attributes that record where a network ran: devices round differently, and the key omits them."""
    return {"device": str(current_device())}
