"""Where things lie on an object store.

::

    moseg-store.json                               format marker
    objects/<task>/<ab>/<key>/manifest.json        the manifest: with it an artifact is there, without it it is not
    payloads/<task>/<ab>/<key>/<attempt>/          its files, a Zarr v3 group
    aside/<task>/<ab>/<key>.json                   manifest of an artifact that a collection is about to delete
    quarantine/<task>-<key>-<id>/                  damaged artifacts, each with a reason
    pins/<run>.json                                what runs need
    logs/<run>/<space>-<pid>-<id>-<n>.jsonl        what happened in a run, an object for each append

Manifests have a tree of their own, so that a listing of artifacts is no listing of their files: a page of a thousand
names holds a thousand artifacts, where beside their files it would hold fifty. An attempt, ``<space>-<pid>-<id>``, is
one put by one process. The manifest names it, so two writers at the same time never mix their files, and what one
leaves behind when it is killed or comes second is nobody's.
"""

from moseg.store.names import MANIFEST, is_key_in, slot

OBJECTS, PAYLOADS, ASIDE, QUARANTINE, LOGS = "objects", "payloads", "aside", "quarantine", "logs"


def manifest_name(ref: str) -> str:
    """Name of an artifact's manifest; raises InputError where the reference is malformed."""
    return f"{OBJECTS}/{slot(ref)}/{MANIFEST}"


def payload_folder(ref: str, attempt: str) -> str:
    """Folder of the files of one put."""
    return f"{PAYLOADS}/{slot(ref)}/{attempt}"


def aside_name(ref: str) -> str:
    """Name of the manifest of an artifact that is taken out of service."""
    return f"{ASIDE}/{slot(ref)}.json"


def ref_of_manifest(name: str) -> str | None:
    """The reference whose manifest bears this name; None where it is no manifest's."""
    parts = name.split("/")
    if len(parts) != 5 or parts[0] != OBJECTS or parts[4] != MANIFEST or not is_key_in(parts[3], parts[2]):
        return None
    return f"{parts[1]}/{parts[3]}"


def ref_of_payload(name: str) -> tuple[str, str] | None:
    """The reference and the attempt that a file belongs to; None where it is no artifact's file."""
    parts = name.split("/", 5)
    if len(parts) != 6 or parts[0] != PAYLOADS or not is_key_in(parts[3], parts[2]):
        return None
    return f"{parts[1]}/{parts[3]}", parts[4]


def ref_of_aside(name: str) -> str | None:
    """The reference whose manifest was set aside under this name; None where it is none."""
    parts = name.removesuffix(".json").split("/")
    if len(parts) != 4 or parts[0] != ASIDE or not is_key_in(parts[3], parts[2]):
        return None
    return f"{parts[1]}/{parts[3]}"
