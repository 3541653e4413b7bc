"""The artifact store of a user who names none: one for all folders, so that no result is computed twice."""

import os
import sys
from pathlib import Path

VARIABLE = "MOSEG_STORE"


def default_store() -> str:
    """Return the store that the environment names, else the one in the user's cache folder.

    The cache folder is ``$XDG_CACHE_HOME`` or ``~/.cache``, ``~/Library/Caches`` on macOS and ``%LOCALAPPDATA%`` on
    Windows.
    """
    return os.environ.get(VARIABLE) or str(_cache_folder() / "moseg" / "store")


def _cache_folder() -> Path:
    if sys.platform == "win32" and (local := os.environ.get("LOCALAPPDATA")):
        return Path(local)
    home = Path(os.path.expanduser("~"))
    if sys.platform == "darwin":
        return home / "Library" / "Caches"
    named = os.environ.get("XDG_CACHE_HOME", "")
    # the specification says that a relative path is to be ignored
    return Path(named) if os.path.isabs(named) else home / ".cache"
