"""Which worker runs networks, and on which device: a GPU is a Dask resource, of which a call takes one."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import NamedTuple, Protocol

from distributed import Client, Status, WorkerPlugin

from moseg.schemas.errors import InputError
from moseg.workflows.process.devices import list_accelerators, set_device
from moseg.workflows.process.threads import pin_threads

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
    """Brings every local worker, also one that is started again, to its threads and its device."""

    name = "moseg-worker"

    def __init__(self, threads: int, plan: Plan):
        self._threads = threads
        self._plan = plan

    async def setup(self, worker):
        pin_threads(self._threads)
        # The first call is not to wait for it.
        import_module("moseg.workflows.engine.execution")
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

    def claim(self, client: Client) -> bool:
        """Whether a call that runs a network must wait for a GPU; raises InputError where one was asked for in vain."""


class OwnGpus:
    """GPUs of this machine, which go to local workers when the first network is to run.

    Before that nobody needs to know how many there are, and to find out takes torch.
    """

    def __init__(self, threads: int, device: str):
        self._threads = threads
        self._device = device
        self._has_any: bool | None = None

    def claim(self, client: Client) -> bool:
        """See `Gpus.claim`."""
        if self._has_any is None:
            accelerators = list_accelerators(self._device)
            if accelerators:
                names = sorted(worker["name"] for worker in client.scheduler_info(-1)["workers"].values())
                set_up_workers(client, self._threads, share_out(names, accelerators))
            self._has_any = bool(accelerators)
        return self._has_any


class ForeignGpus:
    """GPUs that workers of an existing cluster declare.

    Once there was one, networks wait for its like to come back: on a processor they would give other bytes.
    """

    def __init__(self, device: str):
        self._device = device
        self._had_any = False

    def claim(self, client: Client) -> bool:
        """See `Gpus.claim`."""
        if self._device == "cpu" or self._had_any:
            return self._had_any
        workers = client.scheduler_info(-1)["workers"].values()
        if any(worker["resources"].get(GPU) for worker in workers):
            self._had_any = True
            return True
        if self._device == "auto":
            return False
        raise InputError(
            "no worker declares a GPU",
            where=f"--scheduler {client.scheduler.address}",
            got=f"--device {self._device} and {len(workers)} workers",
            expected="dask worker --resources GPU=1, or --device cpu",
        )


def set_up_workers(client: Client, threads: int, plan: Plan) -> None:
    """Set up all local workers, present and future ones."""
    client.register_plugin(WorkerSetup(threads, plan))
