"""The network that a process keeps: loaded for the first task that runs it, released for a task that runs another."""

import gc
import os
import threading
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
            if _RESIDENT:
                # Released first, because the memory may not hold two networks.
                _RESIDENT.clear()
                gc.collect()
            _RESIDENT.append((wanted, _load(build, weights).to(device)))
        with network_context(device):
            yield _RESIDENT[0][1]


def _load(build: Callable[..., Network], weights: ArtifactView) -> Network:
    # Here, because the items of the catalogue are checked against the networks that the stages declare.
    from moseg.workflows.weights.folder import open_weights

    leaf = weights.attributes
    # The weights were fetched before the tasks started; a worker never downloads.
    folder = open_weights(os.environ, offline=True, allow_non_commercial=True)
    item = folder.item(leaf["item"]).model_copy(update={"config": leaf["config"]})
    return build(folder.read(item, leaf["files"]))


def made_on() -> dict[str, str]:
    """Return the attributes that record where a network ran: devices round differently, and the key omits them."""
    return {"device": str(current_device())}
