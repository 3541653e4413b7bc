"""SHA-256 of files."""

import hashlib
from pathlib import Path

_KNOWN: dict[tuple[str, int, int], str] = {}


def sha256_of(path: Path) -> str:
    """Hexadecimal SHA-256 of a file's bytes, read now."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def remembered_sha256(path: Path) -> str:
    """The same, read once in this process as long as size and time of change stay."""
    stat = path.stat()
    state = (str(path.resolve()), stat.st_size, stat.st_mtime_ns)
    if state not in _KNOWN:
        _KNOWN[state] = sha256_of(path)
    return _KNOWN[state]
