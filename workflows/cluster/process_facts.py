"""What a process of a cluster says about itself: its code, its libraries, and what it lacks.

At the top nothing but the standard library is imported, so that a process that lacks a package can still say so.
"""

import platform
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

from moseg.workflows.cluster.code_fingerprint import code_fingerprint

WORK = ("moseg.workflows.engine.execution", "moseg.workflows.engine.ingest")
"""Modules behind every call; they import what any call needs but for networks."""
IMPORTED_LATER = ("kmedoids",)
"""Packages that single tasks import when they first run."""
PROTOCOL = ("dask", "distributed", "cloudpickle", "msgpack")
"""Distributions by which the processes of a cluster talk to each other."""


def process_facts() -> dict[str, Any]:
    """Facts of this process, of plain types that any version understands.

    Returns
    -------
    dict
        `fingerprint` of the code; `lacks`, what it cannot import, else None; `versions` of Python and of the libraries
        that can change a result or garble a message.
    """
    facts: dict[str, Any] = {"fingerprint": code_fingerprint(), "lacks": None, "versions": {}}
    try:
        for module in WORK:
            import_module(module)
        from moseg.store.provenance import library_versions
    except ImportError as error:
        return facts | {"lacks": error.name or str(error)}
    versions = library_versions() | _installed(PROTOCOL)
    # The last digit of Python's version changes neither.
    versions["python"] = ".".join(platform.python_version_tuple()[:2])
    return facts | {"lacks": lacking(IMPORTED_LATER), "versions": versions}


def lacking(packages: tuple[str, ...]) -> str | None:
    """The packages that are not installed here, as text; None where all are."""
    return " and ".join(name for name in packages if not _is_installed(name)) or None


def _is_installed(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ImportError:
        return False


def _installed(names: tuple[str, ...]) -> dict[str, str]:
    found = {}
    for name in names:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
