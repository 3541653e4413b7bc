"""Fingerprint of a plug-in's code, which stands in the keys of what the plug-in computes."""

import sys
from functools import cache
from hashlib import blake2b
from pathlib import Path

from moseg.schemas.errors import InputError

DIGEST_BYTES = 16


@cache
def code_of_plugin(package: str) -> str:
    """Return the fingerprint of every ``.py`` file of a top-level package, or of the one file of a module.

    A comment changes it too: artifacts are computed anew more often than needed, never too seldom.

    Raises
    ------
    InputError
        The code lies in no file, as that of a notebook's cell.
    """
    state = blake2b(digest_size=DIGEST_BYTES, person=b"moseg:plugin")
    for name, path in _sources(package):
        for part in (name.encode(), path.read_bytes().replace(b"\r\n", b"\n")):
            state.update(len(part).to_bytes(8, "little"))
            state.update(part)
    return state.hexdigest()


def _sources(package: str) -> list[tuple[str, Path]]:
    module = sys.modules[package]
    folders = [Path(folder) for folder in getattr(module, "__path__", ())]
    if folders:
        return sorted(
            (path.relative_to(folder).as_posix(), path) for folder in folders for path in folder.rglob("*.py")
        )
    file = getattr(module, "__file__", None)
    if file is None or not Path(file).is_file():
        expected = "a module in a file"
        raise InputError("the code of a plug-in cannot be read", where=package, got="no file", expected=expected)
    return [("", Path(file))]
