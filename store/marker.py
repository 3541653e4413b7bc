"""The marker that makes a place a store of a known format."""

import json
import os
import uuid
from pathlib import Path

from moseg.schemas.errors import MissingStoreError, StoreChoiceError, StoreError

MARKER = "moseg-store.json"
FORMAT = 1
CONTENT = json.dumps({"store": "moseg artifacts", "format": FORMAT}).encode() + b"\n"


def open_root(root: Path, *, create: bool) -> None:
    """Check the marker of a store's root, or make the root a store where it is new or empty.

    Raises
    ------
    StoreError
        The root is missing (and not to be created), not writable, not a store, or of another format.
    """
    content = _read(root)
    if content is None:
        if not create:
            kind = StoreChoiceError if root.exists() else MissingStoreError
            raise kind("no artifact store", where=root, expected=f"a folder with {MARKER}")
        content = _create(root)
    check_marker(content, root / MARKER)


def check_marker(content: bytes, where: object) -> None:
    """Raise StoreChoiceError where a marker's content is not that of a store of this format."""
    try:
        found = json.loads(content)["format"]
    except (ValueError, KeyError, TypeError):
        raise StoreChoiceError("unreadable store marker", where=where, expected=CONTENT.decode().strip()) from None
    if found != FORMAT:
        raise StoreChoiceError("unknown store format", where=where, got=found, expected=FORMAT)


def _read(root: Path) -> bytes | None:
    try:
        return (root / MARKER).read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise StoreChoiceError(f"cannot read the artifact store: {error.strerror}", where=root) from error


def _create(root: Path) -> bytes:
    partial = root / f".{MARKER}.{uuid.uuid4().hex}"
    try:
        root.mkdir(parents=True, exist_ok=True)
        # another process may be creating the same store: its partial marker is no foreign file
        foreign = [name for name in os.listdir(root) if not name.startswith(f".{MARKER}.")]
        if MARKER in foreign:
            return (root / MARKER).read_bytes()
        if foreign:
            raise StoreChoiceError(
                "not an artifact store",
                where=root,
                got=f"{len(foreign)} other files",
                expected="an empty folder or a store",
            )
        partial.write_bytes(CONTENT)
        partial.replace(root / MARKER)
    except StoreError:
        raise
    except OSError as error:
        raise StoreChoiceError(f"cannot create an artifact store: {error.strerror}", where=root) from error
    return CONTENT
