"""What runs on a worker around each call: the process is brought to its threads and device, and its code is checked.

Workers of a cluster that is not ours come and go, and nothing that we leave there may outlive us. So its scheduler gets
no plugin, and every call carries what its process must be like.
"""

from collections.abc import Callable
from threading import Lock
from typing import Any, NamedTuple

from distributed import get_worker

from moseg.schemas.errors import InputError
from moseg.workflows.cluster.code_fingerprint import code_fingerprint, refuse_other_code
from moseg.workflows.cluster.placement import Plan
from moseg.workflows.cluster.process_facts import lacking
from moseg.workflows.plugins.loading import match_plugins
from moseg.workflows.plugins.registered import PluginSet
from moseg.workflows.process.devices import set_device
from moseg.workflows.process.threads import pin_threads


class Setup(NamedTuple):
    """What every process that runs our calls must be like.

    Attributes
    ----------
    code : str
        Fingerprint of the client's code.
    threads : int
    network_packages : tuple of str
        Packages for networks that the client has.
    plan : Plan, optional
        None where the worker was given its threads and its device when it started.
    plugins : PluginSet
        What is registered in the client.
    """

    code: str
    threads: int
    network_packages: tuple[str, ...]
    plan: Plan | None = None
    plugins: PluginSet = PluginSet(())


_lock = Lock()
_ready: tuple[Setup, str | None] | None = None


def prepare_process(setup: Setup, worker=None) -> None:
    """Bring this process to `setup`; raises InputError where its code is another one or its device is missing."""
    global _ready
    worker = worker or get_worker()
    # What a worker declares can change while it lives.
    device = setup.plan and setup.plan.place(worker.name, worker.state.total_resources).device
    with _lock:
        if _ready == (setup, device):
            return
        refuse_other_code(f"worker {worker.address}", code_fingerprint(), setup.code)
        match_plugins(setup.plugins, f"worker {worker.address}")
        if device is not None:
            pin_threads(setup.threads)
            set_device(device)
        _ready = setup, device


def prepare_worker(setup: Setup, dask_worker=None) -> None:
    """The same for `Client.run`."""
    prepare_process(setup, dask_worker)


def run_call(setup: Setup, runs_network: bool, function: Callable[..., Any], arguments: tuple, *_done: object) -> Any:
    """Result of a call, in a process that is brought to `setup` first; what was `_done` before it is in the store.

    Raises
    ------
    InputError
        As `prepare_process`; or the process lacks a package that the call needs.
    """
    prepare_process(setup)
    if runs_network and (missing := lacking(setup.network_packages)):
        raise _lacks(missing)
    try:
        return function(*arguments)
    except ModuleNotFoundError as error:
        raise _lacks(error.name) from error


def _lacks(package: str | None) -> InputError:
    where = f"worker {get_worker().address}"
    expected = "every package of this client in the Python of that worker"
    return InputError(f"no package {package}", where=where, got="not installed", expected=expected)
