"""The interface of a backend: where the bytes of artifacts lie, whatever they mean.

What an artifact is (its codec, its seal, how it is read, verified and collected) is the same on every backend and
stands in `moseg.store.backend_store`, `moseg.store.reading`, `moseg.store.verification` and `moseg.store.collection`.
A backend places files, finds them again, and makes an artifact appear and vanish whole.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import Protocol

from moseg.store.outcomes import PutOutcome


class ManifestSource(Protocol):
    """Somewhere that manifests can be read."""

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        """Content of the manifest file of each artifact that lies here; no bytes where it cannot be read."""


class Trash(ManifestSource, Protocol):
    """Artifacts taken out of service that can still be given back."""

    taken: set[str]

    def take(self, refs: Iterable[str]) -> None:
        """Take artifacts out of service, each at once; those that are not there are passed over."""

    def give_back(self, refs: Iterable[str]) -> None:
        """Put taken artifacts into service again, unless they were computed again meanwhile."""

    def empty(self) -> None:
        """Delete what was taken and not given back."""


class Backend(ManifestSource, Protocol):
    """Files of artifacts, pins and logs. Faults are StoreErrors; a malformed reference is an InputError."""

    @property
    def url(self) -> str:
        """What `store.open_store` takes to open the same place."""

    def has(self, ref: str) -> bool:
        """Whether an artifact is in service: one lookup of a known name."""

    def present(self, refs: Iterable[str]) -> set[str]:
        """Those of the references that are in service."""

    def refs(self, task: str | None = None) -> Iterator[str]:
        """References of all artifacts, or of one task's, in order."""

    def committed(self) -> dict[str, float]:
        """When each artifact was committed here, seconds since the epoch, in order of reference."""

    def nbytes(self, refs: Collection[str]) -> dict[str, int]:
        """Bytes of all files of each artifact."""

    def commit(self, ref: str, files: Mapping[str, bytes | memoryview], seal: Callable[[str], bytes]) -> PutOutcome:
        """Write an artifact's files and then its manifest, what `seal` gives for the name of the files' place."""

    def read_manifest(self, ref: str) -> bytes:
        """Content of the manifest file; raises MissingArtifactError where there is no artifact."""

    def read_files(self, ref: str, payload: str, paths: Iterable[str]) -> dict[str, bytes]:
        """Content of files; `payload` is the place that the manifest names.

        Raises CorruptArtifactError where one is lost and MissingArtifactError where the artifact is gone meanwhile.
        """

    def file_sizes(self, ref: str, payload: str) -> dict[str, int]:
        """Sizes of all files but the manifest that lie there, by relative path."""

    def quarantine(self, ref: str, reason: bytes) -> bool:
        """Take an artifact out of service and keep its bytes aside with a reason; False where it is gone already."""

    def place(self, ref: str, payload: str) -> str:
        """Folder or URL below which an artifact's files lie; `payload` is the place that the manifest names."""

    def new_trash(self) -> Trash:
        """A place of this process for artifacts that are to be deleted."""

    def leftovers(self, now: float, before: float) -> dict[str, int]:
        """What interrupted processes left but pins, and quarantined artifacts of a time before, with their bytes."""

    def discard(self, leftovers: Iterable[str]) -> None:
        """Delete what `leftovers` named."""

    def write_record(self, path: str, content: bytes, purpose: str) -> None:
        """Write a small file at once, in place of an earlier one; an error says that it ``cannot <purpose>``."""

    def read_record(self, path: str) -> bytes | None:
        """Content of a small file; None where there is none."""

    def read_records(self, folder: str) -> dict[str, bytes]:
        """Small files of a folder by path, in order."""

    def delete_record(self, path: str, purpose: str) -> bool:
        """Delete a small file; False where there is none; an error says that it ``cannot <purpose>``."""

    def append_log(self, run_id: str, lines: bytes) -> None:
        """Add whole lines to a run's log."""

    def read_log(self, run_id: str) -> list[bytes]:
        """The lines of a run's log, those of each process in order."""

    def logs(self) -> dict[str, float]:
        """Runs that left a log, with the time at which it last grew."""

    def remove_log(self, run_id: str) -> bool:
        """Delete a run's log; False where there is none."""
