"""What a process of a cluster reports about itself: its code, its libraries, and the packages that it misses.

At the top nothing but the standard library is imported, so that a process without a package can still report that.
"""

import platform
from functools import cache
from hashlib import blake2b
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOMS = ("moseg.schemas", "moseg.store", "moseg.tasks", "moseg.workflows")
FRONT = ("api", "moseg")
"""Folder of `moseg.workflows` in the checkout only: installed, the package `moseg` stands above the rooms."""
DIGEST_BYTES = 8
"""Short enough to be read aloud; the digest distinguishes versions and need not resist forgery."""
WORK = ("moseg.workflows.engine.execution", "moseg.workflows.engine.ingest")
"""Modules behind every call."""
IMPORTED_LATER = ("cv2", "kmedoids", "poselib", "scipy", "sklearn")
"""Packages that single tasks import when they first run."""
PROTOCOL = ("dask", "distributed", "cloudpickle", "msgpack")
"""Distributions by which the processes of a cluster exchange messages."""


def process_facts() -> dict[str, Any]:
    """Return facts about this process, of plain types that any version can read.

    Returns
    -------
    dict
        `fingerprint` of the code; `missing`, the packages that cannot be imported, else None; `versions` of Python and
        of the libraries that can change a result or corrupt a message.
    """
    facts: dict[str, Any] = {"fingerprint": code_fingerprint(), "missing": None, "versions": {}}
    try:
        for module in WORK:
            import_module(module)
        from moseg.store.provenance import library_versions
    except ImportError as error:
        return facts | {"missing": error.name or str(error)}
    versions = library_versions() | _installed_versions(PROTOCOL)
    # The last digit of Python's version changes neither.
    versions["python"] = ".".join(platform.python_version_tuple()[:2])
    return facts | {"missing": missing_packages(IMPORTED_LATER), "versions": versions}


@cache
def code_fingerprint() -> str:
    """Return a digest of the source files of all rooms as this process finds them installed.

    The digest covers the name and the text of every ``.py`` file, with comments but without line ends: a comment
    changes no result, but a difference shows that another version is installed. It is computed once a process, at about
    the time when the code is loaded (some 10 ms for 500 files), so that a worker that was started before an upgrade
    still reports the code that it runs.

    Raises
    ------
    ModuleNotFoundError
        A room is not installed.
    """
    state = blake2b(digest_size=DIGEST_BYTES, person=b"moseg:code")
    for room in ROOMS:
        for folder in _folders(room):
            for path in sorted(folder.rglob("*.py"), key=lambda path: path.relative_to(folder).as_posix()):
                if path.relative_to(folder).parts[:2] == FRONT:
                    continue
                content = path.read_bytes().replace(b"\r\n", b"\n")
                name = f"{room}/{path.relative_to(folder).as_posix()}".encode()
                for part in (name, content):
                    state.update(len(part).to_bytes(8, "little"))
                    state.update(part)
    return state.hexdigest()


def missing_packages(packages: tuple[str, ...]) -> str | None:
    """Return the packages that are not installed here, as text, or None if all are."""
    return " and ".join(name for name in packages if not _is_installed(name)) or None


def _folders(room: str) -> list[Path]:
    spec = find_spec(room)
    if spec is None or not spec.submodule_search_locations:
        raise ModuleNotFoundError(f"No module named {room!r}", name=room)
    return [Path(location) for location in spec.submodule_search_locations]


def _is_installed(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ImportError:
        return False


def _installed_versions(names: tuple[str, ...]) -> dict[str, str]:
    found = {}
    for name in names:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
