"""Marker of a store, references of artifacts and names of runs: their form on every backend."""

import json
import re

from pydantic import TypeAdapter, ValidationError

from moseg.schemas.errors import InputError, StoreChoiceError
from moseg.schemas.recipes import Ref, split_ref

MARKER = "moseg-store.json"
FORMAT = 2
EARLIER_FORMATS = (1,)
"""Formats that are read as they are: in 1 the files of an artifact are separate. A store gets the format of this
version with the first artifact that is put, so that an earlier version, which cannot read that one, refuses it."""
CONTENT = json.dumps({"store": "moseg artifacts", "format": FORMAT}).encode() + b"\n"
MANIFEST = "manifest.json"
REASON = "reason.json"
_KEY = re.compile(r"[0-9a-f]{64}")
_REF = TypeAdapter(Ref)
_RUN_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")


def check_marker(content: bytes, where: object) -> bool:
    """Return whether a marker is that of a store of this format; False for an earlier one.

    Raises StoreChoiceError if it is neither.
    """
    try:
        found = json.loads(content)["format"]
    except (ValueError, KeyError, TypeError):
        raise StoreChoiceError("unreadable store marker", where=where, expected=CONTENT.decode().strip()) from None
    if found not in (FORMAT, *EARLIER_FORMATS):
        raise StoreChoiceError("unknown store format", where=where, got=found, expected=f"{FORMAT} or earlier")
    return found == FORMAT


def check_ref(ref: str) -> str:
    """Return the reference; raises InputError unless it is ``<task>/<64 hexadecimal digits>``."""
    try:
        return _REF.validate_python(ref)
    except ValidationError:
        raise InputError("bad artifact reference", got=repr(ref), expected="<task>/<64 hexadecimal digits>") from None


def check_run_id(run_id: str) -> str:
    """Return the run's name; raises InputError if it could be more than the name of a file."""
    if not _RUN_ID.fullmatch(run_id):
        raise InputError("bad run name", got=repr(run_id), expected="letters, digits, '.', '_' and '-', at most 100")
    return run_id


def slot(ref: str) -> str:
    """Return ``<task>/<ab>/<key>``, an artifact's place in a tree; raises InputError if `ref` is malformed."""
    task, key = split_ref(check_ref(ref))
    return f"{task}/{key[:2]}/{key}"


def is_key_in(key: str, prefix: str) -> bool:
    """Return whether a name in the folder of a key's first two digits is that of an artifact."""
    return key[:2] == prefix and _KEY.fullmatch(key) is not None
