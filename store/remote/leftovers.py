"""Objects that interrupted processes left on an object store."""

from collections import Counter
from collections.abc import Collection, Mapping
from typing import NamedTuple

from moseg.store.owners import is_abandoned
from moseg.store.remote.layout import (
    ASIDE,
    OBJECTS,
    PAYLOADS,
    QUARANTINE,
    aside_name,
    manifest_name,
    payload_folder,
    ref_of_aside,
    ref_of_manifest,
    ref_of_payload,
)
from moseg.store.remote.requests import Found, Requests
from moseg.store.remote.trash import Aside, RemoteTrash, read_aside, stored_files


class Attempt(NamedTuple):
    """The files of one put: of which artifact, and by which process."""

    ref: str
    name: str

    @property
    def folder(self) -> str:
        """Folder of the files."""
        return payload_folder(self.ref, self.name)

    def is_named_in(self, manifest: bytes) -> bool:
        """Return whether a manifest is that of this put: names of attempts are random."""
        return self.name.encode("utf-8") in manifest


def find_leftovers(requests: Requests, now: float, before: float) -> dict[str, int]:
    """Return folders and objects, with their bytes, that no process will finish, and old quarantined artifacts.

    Files that no manifest names are a leftover if the process that put them has ended, or a day has passed. Another
    collection may be setting the manifest aside, or restoring it: it always writes the one before it deletes the
    other. So the lookups are manifest, copy, manifest: one of them finds it.
    """
    sizes, ages = _attempts(requests, now)
    stored = {ref_of_manifest(item.name) for item in requests.listing(OBJECTS)}
    counts = Counter(attempt.ref for attempt in sizes)
    # a manifest whose artifact has files in one place only names that place
    doubtful = [attempt for attempt in sizes if attempt.ref not in stored or counts[attempt.ref] > 1]
    orphans = [attempt for attempt in doubtful if is_abandoned(attempt.name, ages[attempt])]
    orphans = _unnamed_in_service(requests, orphans)

    copies, held, abandoned = _set_aside(requests, now)
    abandoned -= {aside_name(ref) for ref in _restorable(requests, held, abandoned)}
    kept = [aside.manifest for name, aside in held.items() if name not in abandoned]
    orphans = [attempt for attempt in orphans if not any(attempt.is_named_in(manifest) for manifest in kept)]

    found = {attempt.folder: sizes[attempt] for attempt in sorted(_unnamed_in_service(requests, orphans))}
    found |= {name: copies[name].nbytes for name in sorted(abandoned)}
    return found | _old_quarantine(requests, before)


def restore_abandoned(requests: Requests, now: float) -> None:
    """Put artifacts back into service that a process which has ended set aside, if all their files are there."""
    _, held, abandoned = _set_aside(requests, now)
    trash = RemoteTrash(requests, _restorable(requests, held, abandoned))
    trash.restore(list(trash.taken))


def _set_aside(requests: Requests, now: float) -> tuple[dict[str, Found], dict[str, Aside], set[str]]:
    """Return the copies under ``aside/`` by name: objects, contents, and the names that no process will finish."""
    copies = {item.name: item for item in requests.listing(ASIDE) if ref_of_aside(item.name)}
    held = {name: read_aside(content) for name, content in requests.get_many(copies).items() if content is not None}
    abandoned = {name for name, aside in held.items() if is_abandoned(aside.owner, now - copies[name].modified)}
    return copies, held, abandoned


def _restorable(requests: Requests, held: Mapping[str, Aside], names: Collection[str]) -> dict[str, bytes]:
    """Return the manifests, by reference, of copies whose artifact is not in service and has all its files."""
    if not names:
        return {}
    manifests = {ref_of_aside(name): held[name].manifest for name in names}
    in_service = requests.has_many([manifest_name(ref) for ref in manifests])
    files = {ref: stored_files(ref, data) for ref, data in manifests.items() if manifest_name(ref) not in in_service}
    there = requests.has_many([name for each in files.values() for name in each])
    return {ref: manifests[ref] for ref, each in files.items() if each and there.issuperset(each)}


def _attempts(requests: Requests, now: float) -> tuple[dict[Attempt, int], dict[Attempt, float]]:
    """Return the bytes of the files of each put, and the seconds since the last was written."""
    sizes: dict[Attempt, int] = {}
    ages: dict[Attempt, float] = {}
    for item in requests.listing(PAYLOADS):
        owner = ref_of_payload(item.name)
        if owner is not None:
            attempt = Attempt(*owner)
            sizes[attempt] = sizes.get(attempt, 0) + item.nbytes
            ages[attempt] = min(ages.get(attempt, now), now - item.modified)
    return sizes, ages


def _unnamed_in_service(requests: Requests, attempts: Collection[Attempt]) -> list[Attempt]:
    """Return the attempts that no manifest in service names."""
    manifests = requests.get_many([manifest_name(attempt.ref) for attempt in attempts])
    return [attempt for attempt in attempts if not attempt.is_named_in(manifests[manifest_name(attempt.ref)] or b"")]


def _old_quarantine(requests: Requests, before: float) -> dict[str, int]:
    slots: dict[str, list[Found]] = {}
    for item in requests.listing(QUARANTINE):
        slots.setdefault("/".join(item.name.split("/")[:2]), []).append(item)
    return {
        slot: sum(item.nbytes for item in items)
        for slot, items in slots.items()
        if max(item.modified for item in items) <= before
    }
