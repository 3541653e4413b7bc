"""The interface of every artifact store."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Protocol, runtime_checkable

import numpy as np
from pydantic import JsonValue

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Recipe
from moseg.store.outcomes import GcReport, Pin, PutOutcome, StoredArtifact, TaskUsage, VerifyResult


@runtime_checkable
class ArtifactStore(Protocol):
    """Artifacts by reference ``<task>/<key>``; what ``has`` finds is complete.

    Every method that takes a reference raises InputError where it is malformed. Methods that read raise
    MissingArtifactError where nothing is stored and CorruptArtifactError where the bytes are not those committed.
    Instances can be pickled and are cheap to build in a worker.
    """

    @property
    def url(self) -> str:
        """What `store.open_store` takes to open the same store in another process."""

    def has(self, ref: str) -> bool:
        """Whether the artifact is stored: one lookup of a known name."""

    def present(self, refs: Iterable[str]) -> set[str]:
        """Those of the references that are stored: a lookup of a known name each, several at once where that helps."""

    def put(
        self,
        recipe: Recipe,
        arrays: Mapping[str, np.ndarray],
        attributes: Mapping[str, JsonValue] | None = None,
        seconds: float = 0.0,
        dims: Mapping[str, tuple[str, ...]] | None = None,
        digests: Mapping[str, str] | None = None,
    ) -> PutOutcome:
        """Store one artifact, all of it or nothing; the first of several equal puts stays."""

    def manifest(self, ref: str) -> Manifest:
        """What the artifact holds and how it came to be."""

    def attributes(self, ref: str) -> dict[str, JsonValue]:
        """Results that are not arrays."""

    def read(self, ref: str, name: str, check: bool = False) -> np.ndarray:
        """One whole array, the caller's own copy; with `check` its digest too is compared, not only checksums."""

    def read_rows(self, ref: str, name: str, start: int, stop: int) -> np.ndarray:
        """Rows ``start`` to ``stop`` (exclusive) of the leading axis, reading only the chunks that hold them."""

    def refs(self, task: str | None = None) -> Iterator[str]:
        """References of all artifacts, or of one task's, in order."""

    def verify(self, refs: Iterable[str] | None = None) -> Iterator[VerifyResult]:
        """Compare every byte of the artifacts with what their manifests name."""

    def export(self, ref: str) -> StoredArtifact:
        """An artifact with all its files, every byte compared with what its manifest names."""

    def adopt(self, artifact: StoredArtifact) -> PutOutcome:
        """Store what another store exported: the same bytes, and `created`, `host`, `versions` and `seconds` of its
        manifest. Raises CorruptArtifactError where a byte is not as that manifest names it."""

    def place(self, ref: str) -> str:
        """Folder or URL of an artifact's Zarr group, for other programs to read."""

    def quarantine(self, ref: str, reason: str) -> bool:
        """Take an artifact out of service and keep its bytes aside; False where somebody else already did."""

    def remove(self, ref: str) -> bool:
        """Delete an artifact; False where there is none."""

    def pin(self, run_id: str, refs: Iterable[str], lease_seconds: float | None = None) -> None:
        """Keep these references, stored or not yet, and all that they were made from."""

    def unpin(self, run_id: str) -> bool:
        """End a run's pin; False where there is none."""

    def pinned(self) -> dict[str, Pin]:
        """The pins that hold now, by run."""

    def pin_of(self, run_id: str) -> Pin | None:
        """A run's pin where it holds now, looked up by its name; None where there is none."""

    def append_log(self, run_id: str, lines: bytes) -> None:
        """Add whole lines to a run's log; processes of a run may do so at the same time."""

    def read_log(self, run_id: str) -> list[bytes]:
        """The lines of a run's log without their ends, those of each process in order."""

    def logs(self) -> dict[str, float]:
        """Runs that left a log, with the time at which it last grew, seconds since the epoch."""

    def remove_log(self, run_id: str) -> bool:
        """Delete a run's log; False where there is none."""

    def gc(self, *, is_dry: bool = True, grace_seconds: float = 86_400.0) -> GcReport:
        """Delete what no pin reaches."""

    def usage(self) -> dict[str, TaskUsage]:
        """Artifacts and bytes of each task."""
