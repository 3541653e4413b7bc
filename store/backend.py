"""The interface of a backend: storage for the files of artifacts, whatever they mean.

The meaning of an artifact (its codec, its seal, how it is read, verified and collected) is the same on every backend
and is defined in `moseg.store.backend_store` and the modules from which it takes its methods. A backend writes files,
finds them again, and makes each artifact appear and vanish as a whole.
"""

from abc import abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Protocol

from moseg.store.outcomes import PutOutcome
from moseg.store.packing import Range
from moseg.store.protocol import ArtifactStore


class ManifestSource(Protocol):
    """A place from which manifests can be read."""

    @abstractmethod
    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        """Return the manifest file of each artifact that is here; empty bytes if it cannot be read."""


class Trash(ManifestSource, Protocol):
    """Artifacts that were taken out of service and can still be restored."""

    taken: set[str]
    """Artifacts that are out of service; after a `take` that raised, all that may be."""

    def take(self, refs: Iterable[str]) -> None:
        """Take artifacts out of service, each atomically; those that are not stored are skipped."""

    def restore(self, refs: Iterable[str]) -> None:
        """Put taken artifacts back into service, unless they were computed again in the meantime."""

    def empty(self) -> None:
        """Delete the artifacts that were taken and not restored."""


class Backend(ArtifactStore, ManifestSource, Protocol):
    """Operations of a store on its files. Faults are StoreErrors; a malformed reference is an InputError.

    A backend also implements those methods of `ArtifactStore` that read no manifest: `url`, `has`, `present`, `refs`,
    `touch`, `free_nbytes` and the logs.
    """

    @abstractmethod
    def committed(self) -> dict[str, float]:
        """Return when each artifact was last used or committed here, seconds since the epoch, in order of reference."""

    @abstractmethod
    def nbytes(self, refs: Collection[str]) -> dict[str, int]:
        """Return the bytes of all files of each artifact."""

    @abstractmethod
    def commit(self, ref: str, files: Mapping[str, bytes | memoryview], seal: Callable[[str], bytes]) -> PutOutcome:
        """Write an artifact's files and then its manifest.

        `seal` returns the manifest's content for the name of the place of the files.
        """

    @abstractmethod
    def read_manifest(self, ref: str) -> bytes:
        """Return the content of the manifest file; raises MissingArtifactError if there is no artifact."""

    @abstractmethod
    def read_files(self, ref: str, payload: str, paths: Iterable[str]) -> dict[str, bytes]:
        """Return the content of files; `payload` is the place that the manifest names.

        Raises CorruptArtifactError if a file is lost and MissingArtifactError if the artifact has vanished.
        """

    @abstractmethod
    def read_ranges(
        self, ref: str, payload: str, path: str, nbytes: int, ranges: Mapping[str, Range]
    ) -> dict[str, bytes]:
        """Return parts of one file, by name; a part that lies beyond its end is shorter than asked for.

        Raises like `read_files`, and CorruptArtifactError if the file does not have `nbytes` and that is known without
        another request.
        """

    @abstractmethod
    def file_sizes(self, ref: str, payload: str) -> dict[str, int]:
        """Return the sizes of all files of an artifact but the manifest, by relative path."""

    @abstractmethod
    def move_to_quarantine(self, ref: str, reason: bytes) -> bool:
        """Take an artifact out of service and keep its bytes with a reason; return False if it is gone already."""

    @abstractmethod
    def payload_place(self, ref: str, payload: str) -> str:
        """Return the folder or URL of an artifact's files; `payload` is the place that the manifest names."""

    @abstractmethod
    def new_trash(self) -> Trash:
        """Return a place of this process for artifacts that are to be deleted."""

    @abstractmethod
    def restore_abandoned(self, now: float) -> None:
        """Put complete artifacts back into service that a process which has ended took out of it; `now` is the time."""

    @abstractmethod
    def leftovers(self, now: float, before: float) -> dict[str, int]:
        """Return what interrupted processes left, pins excepted, and artifacts quarantined before a time.

        What `restore_abandoned` would put back into service is not among them.
        The names are relative to the store's root; the values are bytes.
        """

    @abstractmethod
    def discard(self, leftovers: Iterable[str]) -> None:
        """Delete leftovers by the names that `leftovers` returned."""

    @abstractmethod
    def write_record(self, path: str, content: bytes, purpose: str) -> None:
        """Write or replace a small file atomically; errors read ``cannot <purpose>``."""

    @abstractmethod
    def read_record(self, path: str) -> bytes | None:
        """Return the content of a small file, or None if there is none."""

    @abstractmethod
    def read_records(self, folder: str) -> dict[str, bytes]:
        """Return the content of the small files of a folder by path, in order."""

    @abstractmethod
    def delete_record(self, path: str, purpose: str) -> bool:
        """Delete a small file; return False if there is none; errors read ``cannot <purpose>``."""
