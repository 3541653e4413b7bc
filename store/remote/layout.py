"""Layout of a store on an object store, and the marker that makes a prefix a store.

::

    moseg-store.json                               format marker
    objects/<task>/<ab>/<key>/manifest.json        the manifest: an artifact is stored if and only if it exists
    payloads/<task>/<ab>/<key>/<attempt>/          arrays.zip, a Zarr v3 group
    aside/<task>/<ab>/<key>.json                   manifest of an artifact that a collection is about to delete
    quarantine/<task>-<key>-<id>/                  damaged artifacts, each with a reason
    pins/<run>.json                                what runs need
    logs/<run>/<space>-<pid>-<id>-<n>.jsonl        what happened in a run, an object for each append

An artifact of very many or very large chunks has the files of its group in place of ``arrays.zip``. Manifests have a
tree of their own, so that a listing of artifacts does not list these files. An attempt, ``<space>-<pid>-<id>``, is one
put by one process. The manifest names it, so two writers at the same time never mix their files, and the files of one
that is killed or comes second belong to no artifact.
"""

from moseg.schemas.errors import MissingStoreError, StoreChoiceError, StoreError
from moseg.store.names import CONTENT, MANIFEST, MARKER, check_marker, is_key_in, slot
from moseg.store.remote.faults import is_passing
from moseg.store.remote.requests import Requests

OBJECTS, PAYLOADS, ASIDE, QUARANTINE, LOGS = "objects", "payloads", "aside", "quarantine", "logs"


def manifest_name(ref: str) -> str:
    """Return the name of an artifact's manifest; raises InputError if the reference is malformed."""
    return f"{OBJECTS}/{slot(ref)}/{MANIFEST}"


def payload_folder(ref: str, attempt: str) -> str:
    """Return the folder of the files of one put."""
    return f"{PAYLOADS}/{slot(ref)}/{attempt}"


def aside_name(ref: str) -> str:
    """Return the name of the manifest of an artifact that is taken out of service."""
    return f"{ASIDE}/{slot(ref)}.json"


def ref_of_manifest(name: str) -> str | None:
    """Return the reference whose manifest has this name; None if it is not a manifest's."""
    parts = name.split("/")
    if len(parts) != 5 or parts[0] != OBJECTS or parts[4] != MANIFEST or not is_key_in(parts[3], parts[2]):
        return None
    return f"{parts[1]}/{parts[3]}"


def ref_of_payload(name: str) -> tuple[str, str] | None:
    """Return the reference and the attempt that a file belongs to; None if it is not an artifact's file."""
    parts = name.split("/", 5)
    if len(parts) != 6 or parts[0] != PAYLOADS or not is_key_in(parts[3], parts[2]):
        return None
    return f"{parts[1]}/{parts[3]}", parts[4]


def ref_of_aside(name: str) -> str | None:
    """Return the reference whose manifest was set aside under this name; None if there is none."""
    parts = name.removesuffix(".json").split("/")
    if len(parts) != 4 or parts[0] != ASIDE or not is_key_in(parts[3], parts[2]):
        return None
    return f"{parts[1]}/{parts[3]}"


def open_prefix(requests: Requests, *, create: bool) -> None:
    """Check a store's marker, once in a process, or make an empty prefix a store.

    Raises
    ------
    StoreChoiceError
        There is no store (and `create` is false), other objects lie there, the format is another, or the bucket is not
        accessible: no such bucket, no access, no connection.
    StoreError
        The server is overloaded, at fault, or does not answer in time.
    """
    if requests.is_store:
        return
    try:
        content = requests.get(MARKER)
        if content is None:
            content = _create_marker(requests, create=create)
    except StoreChoiceError:
        raise
    except StoreError as error:
        _, _, reason = error.parts[0].partition(": ")
        if is_passing(reason):
            raise
        raise StoreChoiceError(f"cannot open the artifact store: {reason}", where=requests.url) from None
    requests.is_current = check_marker(content, f"{requests.url}/{MARKER}")
    requests.is_store = True


def renew_marker(requests: Requests) -> None:
    """Give a store of an earlier format this one."""
    if not requests.is_current:
        requests.put(MARKER, CONTENT)
        requests.is_current = True


def _create_marker(requests: Requests, *, create: bool) -> bytes:
    foreign = next(requests.listing(""), None)
    # another process may have made the store, and put artifacts, since the marker was looked up
    if foreign is not None and (content := requests.get(MARKER)) is not None:
        return content
    if foreign is not None and foreign.name != MARKER:
        raise StoreChoiceError(
            "not an artifact store", where=requests.url, got=foreign.name, expected="an empty prefix or a store"
        )
    if not create:
        raise MissingStoreError("no artifact store", where=requests.url, expected=f"a prefix with {MARKER}")
    if requests.create(MARKER, CONTENT):
        return CONTENT
    return requests.get(MARKER) or b""
