"""From what a user writes after ``--store`` to a store."""

from pathlib import Path
from urllib.parse import unquote, urlsplit

from schemas.errors import InputError
from store.local import LocalStore

SUPPORTED = "a path or file:///path"


def open_store(url: str, create: bool = True) -> LocalStore:
    """Open a store by path or ``file://`` URL.

    Raises
    ------
    InputError
        Any other scheme.
    StoreError
        The folder cannot be used as a store.
    """
    if "://" not in url:
        if not url:
            raise InputError("no artifact store named", got="an empty text", expected=SUPPORTED)
        return LocalStore(Path(url).expanduser(), create=create)
    parts = urlsplit(url)
    if parts.scheme != "file" or parts.netloc not in ("", "localhost") or not parts.path:
        raise InputError("unsupported artifact store", got=url, expected=SUPPORTED)
    return LocalStore(unquote(parts.path), create=create)
