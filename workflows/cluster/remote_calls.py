"""Code that runs on a worker around each call: it sets the process's threads and device, and checks its code.

Workers of an existing cluster come and go, and nothing that this program leaves there may outlive it. So its scheduler
gets no plugin, and every call carries the setup that its process must have.
"""

from collections.abc import Callable
from importlib.util import find_spec
from threading import Lock
from typing import Any, NamedTuple

from distributed import get_worker

from moseg.schemas.errors import InputError, MissingStoreError
from moseg.workflows.cluster.check import refuse_other_code
from moseg.workflows.cluster.placement import PlacementPolicy
from moseg.workflows.cluster.process_facts import code_fingerprint, missing_packages
from moseg.workflows.plugins.loading import match_plugins
from moseg.workflows.plugins.registered import PluginSet, plugins_of_process
from moseg.workflows.process.devices import set_device
from moseg.workflows.process.resources import pin_threads
from moseg.workflows.weights.reading import PACKAGES


class Setup(NamedTuple):
    """The state that every process must have before it runs a call.

    Attributes
    ----------
    code : str
        Fingerprint of the client's code.
    threads : int
    network_packages : tuple of str
        Packages for networks that the client has.
    policy : PlacementPolicy, optional
        None if the worker was given its threads and its device when it started.
    plugins : PluginSet
        What is registered in the client.
    """

    code: str
    threads: int
    network_packages: tuple[str, ...]
    policy: PlacementPolicy | None = None
    plugins: PluginSet = PluginSet(())


_lock = Lock()
_ready: tuple[Setup, str | None] | None = None


def make_setup(threads: int, policy: PlacementPolicy | None = None) -> Setup:
    """Return a setup with the code, the packages and the plug-ins of this process."""
    packages = tuple(name for name in PACKAGES if find_spec(name) is not None)
    return Setup(code_fingerprint(), threads, packages, policy, plugins_of_process())


def prepare_process(setup: Setup, dask_worker=None) -> None:
    """Give this process the state of `setup`; raise InputError if its code differs or its device is missing.

    `Client.run` fills in `dask_worker`.
    """
    global _ready
    worker = dask_worker or get_worker()
    # The resources that a worker declares can change while it runs.
    device = setup.policy and setup.policy.place(worker.name, worker.state.total_resources).device
    with _lock:
        if _ready == (setup, device):
            return
        refuse_other_code(f"worker {worker.address}", code_fingerprint(), setup.code)
        match_plugins(setup.plugins, f"worker {worker.address}")
        if device is not None:
            pin_threads(setup.threads)
            set_device(device)
        _ready = setup, device


def run_call(setup: Setup, runs_network: bool, function: Callable[..., Any], arguments: tuple, *_done: object) -> Any:
    """Return the result of a call, after the process was prepared; the results of `_done` are in the store.

    Raises
    ------
    InputError
        As `prepare_process`; or the process has not a package that the call needs.
    """
    prepare_process(setup)
    if runs_network and (missing := missing_packages(setup.network_packages)):
        raise _missing_package(missing)
    try:
        return function(*arguments)
    except ModuleNotFoundError as error:
        raise _missing_package(error.name) from error
    except MissingStoreError as error:
        if setup.policy is None:
            raise
        # Workers of an existing cluster may be on other machines.
        where = f"worker {get_worker().address}"
        expected = "a folder that every worker has, or the URL of an object store"
        raise InputError("a worker without the store", where=where, got=error, expected=expected) from error


def _missing_package(package: str | None) -> InputError:
    where = f"worker {get_worker().address}"
    expected = "every package of this client in the Python of that worker"
    return InputError(f"no package {package}", where=where, got="not installed", expected=expected)
