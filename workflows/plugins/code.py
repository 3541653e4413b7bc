"""Fingerprint of a plug-in's code, which is part of the keys of the artifacts that the plug-in computes."""

import sys
from functools import cache
from hashlib import blake2b
from pathlib import Path

from moseg.schemas.errors import InputError

OWN_PACKAGE = "moseg"
MAIN, SPAWNED_MAIN = "__main__", "__mp_main__"
"""Names of the main script, in its own process and in one that multiprocessing has spawned."""
DIGEST_BYTES = 16


def code_of_plugin(declared: object, caller: str) -> tuple[str, str]:
    """Return the packages that define an object, and the fingerprint of their code.

    These are the packages of the caller and of the functions in the object, and those that hold the object in a
    variable, or in a list or tuple, because a script may register an object that it imports. The fingerprint covers
    every ``.py`` file of a package, or the file of a module outside any package. A comment changes the fingerprint
    too: artifacts are computed anew more often than needed, never too seldom.

    Parameters
    ----------
    declared : object
        Object that `moseg.register` accepts.
    caller : str
        Name of the module that registers it.

    Raises
    ------
    InputError
        The code is in no file, such as the code of a notebook's cell.
    """
    modules = {caller, type(declared).__module__, *_holders(declared)}
    task = getattr(declared, "task", None)
    modules |= {each.__module__ for each in (getattr(task, "run", None), getattr(task, "run_together", None)) if each}
    found = {module.partition(".")[0] for module in modules} - {OWN_PACKAGE}
    names = sorted(MAIN if name == SPAWNED_MAIN else name for name in found)
    state = blake2b(digest_size=DIGEST_BYTES, person=b"moseg:plugin")
    for name in dict.fromkeys(names):
        state.update(_code_of_package(SPAWNED_MAIN if name == MAIN and SPAWNED_MAIN in sys.modules else name))
    return " ".join(dict.fromkeys(names)), state.hexdigest()


def _holders(declared: object) -> set[str]:
    """Return the names of the modules with a variable that is the object or a list of it."""
    found = set()
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] in sys.stdlib_module_names - {MAIN}:
            continue
        for value in list(getattr(module, "__dict__", {}).values()):
            if value is declared or (type(value) in (list, tuple) and any(each is declared for each in value)):
                found.add(name)
    return found


@cache
def _code_of_package(package: str) -> bytes:
    state = blake2b(digest_size=DIGEST_BYTES)
    for name, path in _sources(package):
        for part in (name.encode(), path.read_bytes().replace(b"\r\n", b"\n")):
            state.update(len(part).to_bytes(8, "little"))
            state.update(part)
    return state.digest()


def _sources(package: str) -> list[tuple[str, Path]]:
    module = sys.modules[package]
    folders = [Path(folder) for folder in getattr(module, "__path__", ())]
    if folders:
        found = [(path.relative_to(folder).as_posix(), path) for folder in folders for path in folder.rglob("*.py")]
        return sorted(found)
    file = getattr(module, "__file__", None)
    if file is None or not Path(file).is_file():
        expected = "a module in a file"
        raise InputError("the code of a plug-in cannot be read", where=package, got="no file", expected=expected)
    return [("", Path(file))]
