"""Artifacts taken out of service on an object store before they are deleted.

There is no rename. A collection first writes a copy of the manifest under ``aside/`` that only one process at a time
can own, then deletes the manifest: this takes the artifact out of service. Its files stay until the collection has read
the pins again. A process that is killed or fails in between leaves the copy, which names the process, and files that no
manifest names. The next collection after the end of that process puts the artifact back into service if all its files
are there (the copy is deleted last), and deletes the rest.
"""

from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

from moseg.schemas.errors import CorruptArtifactError
from moseg.store.owners import is_abandoned, owned_name
from moseg.store.reading import check_seal
from moseg.store.remote.layout import aside_name, manifest_name, payload_folder
from moseg.store.remote.requests import Requests


class Aside(NamedTuple):
    """A manifest that was set aside, and the process that did it."""

    owner: str
    manifest: bytes


def read_aside(content: bytes) -> Aside:
    """Parse an object under ``aside/``."""
    owner, _, manifest = content.partition(b"\n")
    return Aside(owner.decode("ascii", "replace"), manifest)


class RemoteTrash:
    """A `Trash` of manifests under ``aside/``.

    Parameters
    ----------
    manifests : dict of str to bytes, optional
        By reference: manifests that a process which has ended set aside. Later ones belong to this process.
    """

    def __init__(self, requests: Requests, manifests: Mapping[str, bytes] | None = None):
        self._requests = requests
        self._owner = owned_name()
        self._manifests = dict(manifests or {})
        self.taken = set(self._manifests)

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        return {ref: self._manifests[ref] for ref in refs if ref in self._manifests}

    def take(self, refs: Iterable[str]) -> None:
        """Set manifests aside; skip artifacts that another process is taking."""
        names = {manifest_name(ref): ref for ref in refs}
        found = {names[name]: data for name, data in self._requests.get_many(names).items() if data is not None}
        self._drop_abandoned(found)
        copies = {aside_name(ref): self._owner.encode("ascii") + b"\n" + data for ref, data in found.items()}
        owned = self._requests.create_many(copies)
        self._manifests |= {ref: data for ref, data in found.items() if aside_name(ref) in owned}
        # before the requests: if one of them fails, any of the manifests may be gone
        self.taken |= self._manifests.keys()
        self._requests.delete(manifest_name(ref) for ref in self._manifests)

    def restore(self, refs: Iterable[str]) -> None:
        """Write manifests again; an artifact that was computed again in the meantime stays."""
        names = {manifest_name(ref): ref for ref in refs}
        created = self._requests.create_many({name: self._manifests[ref] for name, ref in names.items()})
        # a request that the client repeats because the answer was lost finds the object that it wrote
        there = self._requests.get_many(names.keys() - created)
        back = [ref for name, ref in names.items() if name in created or there[name] == self._manifests[ref]]
        self._requests.delete(map(aside_name, back))
        for ref in back:
            del self._manifests[ref]
        self.taken -= set(names.values())

    def empty(self) -> None:
        """Delete the files of the taken artifacts, and the copies of their manifests last."""
        files = [name for ref, data in self._manifests.items() for name in stored_files(ref, data)]
        self._requests.delete(files)
        self._requests.delete(map(aside_name, self._manifests))
        self._manifests.clear()

    def _drop_abandoned(self, refs: Iterable[str]) -> None:
        """Delete copies of manifests that killed processes left of artifacts that are still in service."""
        claims = self._requests.get_many([aside_name(ref) for ref in refs])
        owners = {name: read_aside(content).owner for name, content in claims.items() if content is not None}
        # the age of a copy does not matter if its process can be checked; other copies are left to `leftovers`
        self._requests.delete(name for name, owner in owners.items() if is_abandoned(owner, age=0))


def stored_files(ref: str, data: bytes) -> list[str]:
    """Return the names of an artifact's files; none if the manifest is damaged: they are left to `leftovers`."""
    try:
        sealed = check_seal(ref, data)
    except CorruptArtifactError:
        return []
    folder = payload_folder(ref, sealed.payload)
    return [f"{folder}/{path}" for path in sealed.stored_sizes()]
