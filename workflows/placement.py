"""Which worker runs networks, and on which device: a GPU is a Dask resource, of which a call takes one."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import NamedTuple, Protocol

from distributed import Client, Status, WorkerPlugin

from schemas.errors import InputError
from workflows.devices import list_accelerators, set_device
from workflows.threads import pin_threads

GPU = "GPU"
"""Name of the resource; a worker of an own cluster declares it by ``dask worker --resources GPU=1``."""


class Placement(NamedTuple):
    """A worker's device, and the resources that it gets on top of those that it declares itself."""

    device: str
    resources: Mapping[str, int] = {}


class Plan(Protocol):
    """Says where the workers of a cluster compute."""

    def place(self, name: Hashable, declared: Mapping[str, float]) -> Placement:
        """Placement of the worker `name`, which itself declares these resources."""


@dataclass(frozen=True)
class OwnWorkers:
    """Local workers: an accelerator belongs to one worker, and the others compute on the CPU."""

    accelerators: Mapping[Hashable, str] = field(default_factory=dict)

    def place(self, name: Hashable, declared: Mapping[str, float]) -> Placement:
        """See `Plan.place`."""
        if name in self.accelerators:
            return Placement(self.accelerators[name], {GPU: 1})
        return Placement("cpu")


@dataclass(frozen=True)
class ForeignWorkers:
    """Workers of a cluster that is not ours: those that declare a GPU use it; a GPU that none declares is let alone."""

    device: str

    def place(self, name: Hashable, declared: Mapping[str, float]) -> Placement:
        """See `Plan.place`."""
        return Placement(self.device if declared.get(GPU) else "cpu")


def share_out(names: Sequence[Hashable], accelerators: Sequence[str]) -> OwnWorkers:
    """One accelerator for each of the first workers, as far as either reaches."""
    return OwnWorkers(dict(zip(names, accelerators, strict=False)))


class WorkerSetup(WorkerPlugin):
    """Brings every worker, also one that joins later, to its threads and its device."""

    name = "moseg-worker"

    def __init__(self, threads: int, plan: Plan):
        self._threads = threads
        self._plan = plan

    async def setup(self, worker):
        pin_threads(self._threads)
        # A worker that cannot import the tasks is found out now; a call sent to it would never come back.
        import_module("workflows.execution")
        placement = self._plan.place(worker.name, worker.state.total_resources)
        set_device(placement.device)
        if placement.resources:
            await worker.set_resources(**placement.resources)
            # The scheduler looks for calls that wait for resources when a worker starts to run, which one that was
            # restarted after a crash did before it had any.
            worker.status = Status.paused
            worker.status = Status.running


class Gpus(Protocol):
    """The GPUs of a cluster."""

    def claim(self) -> bool:
        """Whether a call that runs a network must wait for a GPU; raises InputError where one was asked for in vain."""


class OwnGpus:
    """GPUs of this machine, which go to local workers when the first network is to run.

    Before that nobody needs to know how many there are, and to find out takes torch.
    """

    def __init__(self, client: Client, threads: int, device: str):
        self._client = client
        self._threads = threads
        self._device = device
        self._has_any: bool | None = None
        set_up_workers(client, threads, OwnWorkers())

    def claim(self) -> bool:
        """See `Gpus.claim`."""
        if self._has_any is None:
            accelerators = list_accelerators(self._device)
            if accelerators:
                names = sorted(worker["name"] for worker in self._client.scheduler_info()["workers"].values())
                set_up_workers(self._client, self._threads, share_out(names, accelerators))
            self._has_any = bool(accelerators)
        return self._has_any


class ForeignGpus:
    """GPUs that workers of an existing cluster declare."""

    def __init__(self, client: Client, threads: int, device: str):
        self._client = client
        self._device = device
        set_up_workers(client, threads, ForeignWorkers(device))

    def claim(self) -> bool:
        """See `Gpus.claim`."""
        workers = self._client.scheduler_info()["workers"].values()
        if self._device == "cpu":
            return False
        if any(worker["resources"].get(GPU) for worker in workers):
            return True
        if self._device == "auto":
            return False
        raise InputError(
            "no worker declares a GPU",
            where=f"--scheduler {self._client.scheduler.address}",
            got=f"--device {self._device} and {len(workers)} workers",
            expected="dask worker --resources GPU=1, or --device cpu",
        )


def set_up_workers(client: Client, threads: int, plan: Plan) -> None:
    """Set up all workers, present and future ones; raises InputError where one cannot run moseg or lacks its device."""
    try:
        client.register_plugin(WorkerSetup(threads, plan))
    except ImportError as error:
        expected = "the same moseg on every worker"
        raise InputError("workers that cannot run moseg's tasks", got=error, expected=expected) from error
