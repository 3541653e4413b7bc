"""Taking a damaged artifact out of service with its bytes kept aside, on a file system."""

import os
import shutil
import uuid

from moseg.schemas.errors import StoreError
from moseg.schemas.recipes import split_ref
from moseg.store.layout import Layout

REASON = "reason.json"


def quarantine(layout: Layout, ref: str, reason: bytes) -> bool:
    """Move an artifact to ``quarantine/``, beside the reason; False where it is gone already.

    The reason is written first and the move is one rename, so an artifact is never half in service. Several processes
    may quarantine the same artifact: one moves it.
    """
    folder = layout.folder(ref)
    task, key = split_ref(ref)
    slot = layout.quarantine / f"{task}-{key}-{uuid.uuid4().hex}"
    try:
        layout.make_folder(slot)
        (slot / REASON).write_bytes(reason)
        try:
            os.rename(folder, slot / "artifact")
        except FileNotFoundError:
            shutil.rmtree(slot, ignore_errors=True)
            return False
    except OSError as error:
        raise StoreError(f"cannot quarantine an artifact: {error.strerror}", where=layout.root, got=ref) from error
    return True
