"""Fingerprint of a plug-in's code, which stands in the keys of what the plug-in computes."""

import inspect
import sys
from functools import cache
from hashlib import blake2b
from pathlib import Path

OWN_PACKAGE = "moseg"
DIGEST_BYTES = 16


def plugin_fingerprint(declared: object) -> str | None:
    """Return the fingerprint of the code behind a function or an object; None if it is of this project.

    The code of a plug-in is every ``.py`` file of the top-level package, or the one module, that defines it. A comment
    changes it too: the artifacts are computed anew more often than needed, never too seldom.

    Parameters
    ----------
    declared : function, class or object
        Of a plug-in, an object of a class of its own, or a function.
    """
    module = getattr(declared, "__module__", None) or type(declared).__module__
    package = module.partition(".")[0]
    return None if package == OWN_PACKAGE else _fingerprint(package)


@cache
def _fingerprint(package: str) -> str:
    state = blake2b(digest_size=DIGEST_BYTES, person=b"moseg:plugin")
    for name, content in _sources(package):
        for part in (name.encode(), content.replace(b"\r\n", b"\n")):
            state.update(len(part).to_bytes(8, "little"))
            state.update(part)
    return state.hexdigest()


def _sources(package: str) -> list[tuple[str, bytes]]:
    module = sys.modules[package]
    folders = [Path(folder) for folder in getattr(module, "__path__", ())]
    if folders:
        found = [(path.relative_to(folder).as_posix(), path) for folder in folders for path in folder.rglob("*.py")]
        return [(name, path.read_bytes()) for name, path in sorted(found)]
    return [(package, inspect.getsource(module).encode())]
