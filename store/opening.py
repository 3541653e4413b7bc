"""Opening a store by the path or URL that a user gives as ``--store``."""

import os
from pathlib import Path
from urllib.parse import unquote_to_bytes, urlsplit

from moseg.schemas.errors import InputError
from moseg.store.local import LocalStore
from moseg.store.protocol import ArtifactStore

REMOTE = ("s3", "s3a", "gs", "az", "azure", "adl", "abfs", "abfss")
"""Schemes of object stores; ``http://`` is read-only and not supported."""
SUPPORTED = "a path, file:///path, s3://bucket/prefix, gs://bucket/prefix or az://container/prefix"


def open_store(url: str, create: bool = True) -> ArtifactStore:
    """Open a store by path, ``file://`` URL or URL of an object store.

    Raises
    ------
    InputError
        Any other scheme, or a place that cannot be opened as a store.
    """
    if "://" not in url:
        if not url:
            raise InputError("no artifact store named", got="an empty string", expected=SUPPORTED)
        return LocalStore(Path(url).expanduser(), create=create)
    parts = urlsplit(url)
    if parts.scheme in REMOTE:
        # slow to import, and most stores are local
        from moseg.store.remote import RemoteStore

        return RemoteStore(url, create=create)
    if parts.scheme != "file" or parts.netloc not in ("", "localhost") or not parts.path:
        raise InputError("unsupported artifact store", got=f"{parts.scheme}://", expected=SUPPORTED)
    return LocalStore(os.fsdecode(unquote_to_bytes(parts.path)), create=create)
