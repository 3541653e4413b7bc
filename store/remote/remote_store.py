"""The store on an object store: writing the manifest, last, is the commit.

Only pins are ever changed in place. A put writes files under a name of its own (see
`moseg.store.remote.layout`) and then the manifest, on the condition that there is none: the first of several writers
wins, the others delete their own files. On a server that ignores the condition the last writer wins. Its manifest then
names its own files, and those of the first are leftovers, so that no reader ever sees bytes of both.
"""

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress

from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError, StoreError
from moseg.schemas.recipes import split_ref
from moseg.store.backend_store import BackendStore
from moseg.store.names import MANIFEST, REASON
from moseg.store.outcomes import PutOutcome
from moseg.store.owners import is_owned_name, owned_name
from moseg.store.packing import Range
from moseg.store.reading import check_seal
from moseg.store.remote.layout import (
    OBJECTS,
    PAYLOADS,
    QUARANTINE,
    manifest_name,
    open_prefix,
    payload_folder,
    ref_of_manifest,
    ref_of_payload,
    renew_marker,
)
from moseg.store.remote.leftovers import find_leftovers, restore_abandoned
from moseg.store.remote.logs import RemoteLogs
from moseg.store.remote.requests import requests_for
from moseg.store.remote.trash import RemoteTrash

_PAUSES = (0.0, 0.1, 0.5)
"""Seconds to wait before each attempt to put a manifest, when another writer's was found and then vanished."""


class RemoteStore(RemoteLogs, BackendStore):
    """Artifacts below a URL of an object store; the name of each manifest is known, so a lookup is one request.

    `moseg.store.remote.connection` documents the environment variables that are read.

    Parameters
    ----------
    url : str
        ``s3://bucket/prefix``, ``gs://…``, ``az://…`` or ``abfs://…``: a store or, with `create`, an empty prefix that
        becomes one. The bucket must exist.

    Raises
    ------
    InputError
        The URL or the environment is invalid, or other objects lie there.
    """

    def __init__(self, url: str, create: bool = True):
        self._requests = requests_for(url)
        open_prefix(self._requests, create=create)

    @property
    def url(self) -> str:
        # without credentials
        return self._requests.url

    def has(self, ref: str) -> bool:
        return self._requests.has(manifest_name(ref))

    def present(self, refs: Iterable[str]) -> set[str]:
        names = {manifest_name(ref): ref for ref in refs}
        return {names[name] for name in self._requests.has_many(names)}

    def refs(self, task: str | None = None) -> Iterator[str]:
        return iter(self._committed(OBJECTS if task is None else f"{OBJECTS}/{task}"))

    def committed(self) -> dict[str, float]:
        # by the server's clock
        return self._committed(OBJECTS)

    def touch(self, refs: Iterable[str]) -> None:
        """Do nothing: an object's time changes only when it is written."""

    def free_nbytes(self) -> int | None:
        return None

    def nbytes(self, refs: Collection[str]) -> dict[str, int]:
        sizes = dict.fromkeys(refs, 0)
        for task in sorted({split_ref(ref)[0] for ref in refs}):
            for item in self._requests.listing(f"{OBJECTS}/{task}"):
                ref = ref_of_manifest(item.name)
                if ref in sizes:
                    sizes[ref] += item.nbytes
            for item in self._requests.listing(f"{PAYLOADS}/{task}"):
                owner = ref_of_payload(item.name)
                if owner is not None and owner[0] in sizes:
                    sizes[owner[0]] += item.nbytes
        return sizes

    def commit(self, ref: str, files: Mapping[str, bytes | memoryview], seal: Callable[[str], bytes]) -> PutOutcome:
        renew_marker(self._requests)
        attempt = owned_name()
        folder = payload_folder(ref, attempt)
        self._requests.put_many({f"{folder}/{path}": content for path, content in files.items()})
        manifest, name = seal(attempt), manifest_name(ref)
        for pause in _PAUSES:
            time.sleep(pause)
            if self._requests.create(name, manifest):
                return PutOutcome.COMMITTED
            found = self._requests.get(name)
            # a request that the client repeats because the answer was lost finds the object that it wrote
            if found == manifest:
                return PutOutcome.COMMITTED
            if found is not None:
                # files that cannot be deleted now are leftovers of this process
                with suppress(StoreError):
                    self._requests.delete(f"{folder}/{path}" for path in files)
                return PutOutcome.LOST_RACE
        raise StoreError("cannot commit: another process puts and removes this artifact", where=self.url, got=ref)

    def read_manifest(self, ref: str) -> bytes:
        content = self._requests.get(manifest_name(ref))
        if content is None:
            raise MissingArtifactError("no such artifact", where=ref)
        return content

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        names = {manifest_name(ref): ref for ref in refs}
        found = self._requests.get_many(names)
        return {names[name]: content for name, content in found.items() if content is not None}

    def read_files(self, ref: str, payload: str, paths: Iterable[str]) -> dict[str, bytes]:
        folder = self._folder(ref, payload)
        names = {f"{folder}/{path}": path for path in paths}
        found = self._requests.get_many(names)
        lost = [names[name] for name, content in found.items() if content is None]
        if lost:
            self._check_in_service(ref, payload)
            raise CorruptArtifactError("lost file", where=f"{ref} {lost[0]}", ref=ref)
        return {names[name]: content for name, content in found.items()}

    def read_ranges(
        self, ref: str, payload: str, path: str, nbytes: int, ranges: Mapping[str, Range]
    ) -> dict[str, bytes]:
        name = f"{self._folder(ref, payload)}/{path}"
        found = self._requests.get_ranges(name, ranges)
        if found is None:
            self._check_in_service(ref, payload)
            raise CorruptArtifactError("lost file", where=f"{ref} {path}", ref=ref)
        return found

    def file_sizes(self, ref: str, payload: str) -> dict[str, int]:
        folder = self._folder(ref, payload)
        sizes = {item.name.removeprefix(f"{folder}/"): item.nbytes for item in self._requests.listing(folder)}
        self._check_in_service(ref, payload)
        return sizes

    def move_to_quarantine(self, ref: str, reason: bytes) -> bool:
        """Copy the manifest to a folder beside the reason, delete it, and then move the files there.

        Of several processes that quarantine the same artifact, True is returned to the one that wrote the reason first.
        """
        name = manifest_name(ref)
        manifest = self._requests.get(name)
        if manifest is None:
            return False
        task, key = split_ref(ref)
        slot = f"{QUARANTINE}/{task}-{key}-{digest_bytes('quarantine', manifest)[:32]}"
        is_first = self._requests.create(f"{slot}/{REASON}", reason)
        self._requests.put(f"{slot}/artifact/{MANIFEST}", manifest)
        # but not another one, computed again in the meantime
        if self._requests.get(name) == manifest:
            self._requests.delete([name])
        try:
            folder = self._folder(ref, check_seal(ref, manifest).payload)
        except CorruptArtifactError:
            # its own files are unknown: they are leftovers
            return is_first
        names = [item.name for item in self._requests.listing(folder)]
        self._requests.copy_many({source: f"{slot}/artifact{source.removeprefix(folder)}" for source in names})
        self._requests.delete(names)
        return is_first

    def payload_place(self, ref: str, payload: str) -> str:
        return f"{self.url}/{self._folder(ref, payload)}"

    def new_trash(self) -> RemoteTrash:
        return RemoteTrash(self._requests)

    def restore_abandoned(self, now: float) -> None:
        restore_abandoned(self._requests, now)

    def leftovers(self, now: float, before: float) -> dict[str, int]:
        return find_leftovers(self._requests, now, before)

    def discard(self, leftovers: Iterable[str]) -> None:
        for name in leftovers:
            self._requests.delete([name, *(item.name for item in self._requests.listing(name))])

    def write_record(self, path: str, content: bytes, purpose: str) -> None:
        self._requests.put(path, content, purpose)

    def read_record(self, path: str) -> bytes | None:
        return self._requests.get(path)

    def read_records(self, folder: str) -> dict[str, bytes]:
        names = sorted(item.name for item in self._requests.listing(folder))
        return {name: content for name, content in self._requests.get_many(names).items() if content is not None}

    def delete_record(self, path: str, purpose: str) -> bool:
        if not self._requests.has(path):
            return False
        self._requests.delete([path], purpose)
        return True

    def _committed(self, folder: str) -> dict[str, float]:
        found = {ref_of_manifest(item.name): item.modified for item in self._requests.listing(folder)}
        return {ref: found[ref] for ref in sorted(found.keys() - {None})}

    def _folder(self, ref: str, payload: str) -> str:
        if not is_owned_name(payload):
            raise CorruptArtifactError("a manifest that names no files", where=ref, got=repr(payload), ref=ref)
        return payload_folder(ref, payload)

    def _check_in_service(self, ref: str, payload: str) -> None:
        """Raise MissingArtifactError if the artifact has vanished, or was computed again, since it was looked up."""
        manifest = self._requests.get(manifest_name(ref))
        if manifest is None or payload.encode("ascii") not in manifest:
            raise MissingArtifactError("no such artifact", where=ref)
