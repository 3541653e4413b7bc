"""Where things lie under a local store's root, and what a reference must look like."""

import re
from collections.abc import Iterator
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from schemas.errors import InputError
from schemas.recipes import Ref, split_ref

MANIFEST = "manifest.json"
_KEY = re.compile(r"[0-9a-f]{64}")
_REF = TypeAdapter(Ref)
_RUN_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")


class Layout:
    """Folders of a store::

    moseg-store.json                    format marker
    objects/<task>/<ab>/<key>/          one artifact: a Zarr v3 group and its manifest
    staging/<space>-<pid>-<id>/         puts and removals under way
    quarantine/<task>-<key>-<id>/       damaged artifacts, each with a reason
    pins/<run>.json                     what runs need
    logs/<run>/<space>-<pid>.jsonl      what happened in a run, a file for each of its processes
    """

    def __init__(self, root: Path):
        self.root = root
        self.objects = root / "objects"
        self.staging = root / "staging"
        self.quarantine = root / "quarantine"
        self.pins = root / "pins"
        self.logs = root / "logs"
        # str operations: a lookup with pathlib costs more than the stat itself
        self._objects = str(self.objects)

    def folder(self, ref: str) -> str:
        """Folder of an artifact; raises InputError where the reference is malformed."""
        task, key = split_ref(check_ref(ref))
        return f"{self._objects}/{task}/{key[:2]}/{key}"

    def refs(self, task: str | None = None) -> Iterator[str]:
        """References of the artifacts that lie here, in order; entries that are not artifacts are passed over."""
        tasks = _names(self.objects) if task is None else [task]
        for name in tasks:
            for prefix in _names(self.objects / name):
                for key in _names(self.objects / name / prefix):
                    if key[:2] == prefix and _KEY.fullmatch(key):
                        yield f"{name}/{key}"


def check_ref(ref: str) -> str:
    """The reference itself; raises InputError where it is not ``<task>/<64 hexadecimal digits>``."""
    try:
        return _REF.validate_python(ref)
    except ValidationError:
        raise InputError("bad artifact reference", got=repr(ref), expected="<task>/<64 hexadecimal digits>") from None


def check_run_id(run_id: str) -> str:
    """The run's name itself; raises InputError where it could be more than the name of a file."""
    if not _RUN_ID.fullmatch(run_id):
        raise InputError("bad run name", got=repr(run_id), expected="letters, digits, '.', '_' and '-', at most 100")
    return run_id


def _names(folder: Path) -> list[str]:
    try:
        return sorted(entry.name for entry in folder.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []
