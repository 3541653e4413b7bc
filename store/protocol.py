"""The interface of every artifact store."""

from abc import abstractmethod
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Protocol, runtime_checkable

import numpy as np
from pydantic import JsonValue

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Recipe
from moseg.store.outcomes import GcReport, Pin, PutOutcome, StoredArtifact, TaskUsage, VerifyResult


@runtime_checkable
class ArtifactStore(Protocol):
    """Artifacts by reference ``<task>/<key>``; an artifact that `has` finds is complete.

    Every method that takes a reference raises InputError if it is malformed. Methods that read raise
    MissingArtifactError if nothing is stored and CorruptArtifactError if the bytes differ from those committed.
    Instances can be pickled and are cheap to build in a worker.
    """

    @property
    @abstractmethod
    def url(self) -> str:
        """Path or URL with which `store.open_store` opens the same store in another process."""

    @abstractmethod
    def has(self, ref: str) -> bool:
        """Return whether the artifact is stored: one lookup of a known name."""

    @abstractmethod
    def present(self, refs: Iterable[str]) -> set[str]:
        """Return the references that are stored: one lookup of a known name each, concurrent where that is faster."""

    @abstractmethod
    def put(
        self,
        recipe: Recipe,
        arrays: Mapping[str, np.ndarray],
        attributes: Mapping[str, JsonValue] | None = None,
        seconds: float = 0.0,
        dims: Mapping[str, tuple[str, ...]] | None = None,
        digests: Mapping[str, str] | None = None,
    ) -> PutOutcome:
        """Store one artifact completely or not at all; of several equal puts the first stays.

        Parameters
        ----------
        arrays : dict of ndarray
            By name.
        attributes : dict of JSON values
            Results that are not arrays; finite and exact, as in a recipe.
        seconds : float
            Time that the task took.
        dims : dict of axis names, optional
            Axis names of each array; none may be left out.
        digests : dict of str, optional
            `hash_array` of the arrays for which the caller has it.

        Raises
        ------
        StoreError
            The axis names do not fit the arrays, or the backend cannot write.
        TypeError, ValueError
            JSON cannot represent the attributes exactly.
        """

    @abstractmethod
    def manifest(self, ref: str) -> Manifest:
        """Return the artifact's manifest: its contents and how they were computed."""

    @abstractmethod
    def attributes(self, ref: str) -> dict[str, JsonValue]:
        """Return the results that are not arrays."""

    @abstractmethod
    def read(self, ref: str, name: str, check: bool = False) -> np.ndarray:
        """Return a copy of one whole array; with `check`, compare its digest too, not only checksums."""

    @abstractmethod
    def read_rows(self, ref: str, name: str, start: int, stop: int) -> np.ndarray:
        """Return rows ``start`` to ``stop`` (exclusive) of the leading axis, reading only the chunks that hold them.

        Raises InputError if the rows lie outside the array.
        """

    @abstractmethod
    def refs(self, task: str | None = None) -> Iterator[str]:
        """Iterate over the references of all artifacts, or of one task's, in order."""

    @abstractmethod
    def verify(self, refs: Iterable[str] | None = None) -> Iterator[VerifyResult]:
        """Compare every byte of the artifacts, by default of all, with their manifests.

        Artifacts that vanish during the pass are skipped. Raises MissingArtifactError if one of `refs` is not stored.
        """

    @abstractmethod
    def export_artifact(self, ref: str) -> StoredArtifact:
        """Return an artifact with all its files, after comparing every byte with its manifest."""

    @abstractmethod
    def import_artifact(self, artifact: StoredArtifact) -> PutOutcome:
        """Store an artifact that another store exported: the same bytes.

        `created`, `host`, `versions` and `seconds` of its manifest stay. Raises CorruptArtifactError if a byte differs
        from its manifest.
        """

    @abstractmethod
    def place(self, ref: str) -> str:
        """Return the folder or URL of an artifact's Zarr group, for other programs to read."""

    @abstractmethod
    def quarantine(self, ref: str, reason: str) -> bool:
        """Take an artifact out of service and keep its bytes; return False if it is gone already."""

    @abstractmethod
    def remove(self, ref: str) -> bool:
        """Delete an artifact as a whole; return False if there is none."""

    @abstractmethod
    def pin(
        self,
        run_id: str,
        refs: Iterable[str],
        lease_seconds: float | None = None,
        *,
        run: str = "",
        with_inputs: bool = True,
    ) -> None:
        """Protect references, stored or not yet, and everything they were computed from, from `gc`.

        The pin replaces an earlier one of the same name. It holds until `unpin`, or with a lease while this process
        runs and the lease lasts.

        Parameters
        ----------
        run : str
            Name of the run, if the pin has another name.
        with_inputs : bool
            Whether to protect what the references were computed from.
        """

    @abstractmethod
    def unpin(self, run_id: str) -> bool:
        """End a run's pin; return False if there is none."""

    @abstractmethod
    def pinned(self) -> dict[str, Pin]:
        """Return the pins that hold now, by run.

        Raises StoreError if a pin cannot be read: without it a collection could delete what the pin protects.
        """

    @abstractmethod
    def pin_of(self, run_id: str) -> Pin | None:
        """Return a run's pin if it holds now, else None: one lookup by name, however many pins there are."""

    @abstractmethod
    def append_log(self, run_id: str, lines: bytes) -> None:
        """Add whole lines to a run's log; processes of a run may do so at the same time."""

    @abstractmethod
    def read_log(self, run_id: str) -> list[bytes]:
        """Return the lines of a run's log without their ends, those of each process in order."""

    @abstractmethod
    def logs(self) -> dict[str, float]:
        """Return the runs that have a log, with the time of its last append, seconds since the epoch."""

    @abstractmethod
    def remove_log(self, run_id: str) -> bool:
        """Delete a run's log; return False if there is none."""

    @abstractmethod
    def gc(
        self,
        *,
        is_dry: bool = True,
        grace_seconds: float = 86_400.0,
        forget: Collection[str] = (),
        keep_nbytes: int | None = None,
    ) -> GcReport:
        """Delete artifacts that no pin reaches and that are older than the grace period, or only report them.

        What was written since a lease of the last day began is spared too: a run at work may not have named it yet.

        A pin reaches the references it names and, through the inputs in manifests, everything they were computed from;
        an input that is not stored ends the walk. Unfinished puts, quarantined artifacts older than the grace period,
        and pins that no longer hold are deleted too. Artifacts that a killed or failed collection took out of service
        are restored first.

        Parameters
        ----------
        grace_seconds : float
            Time since the last use (see `touch`) for which an artifact is kept.
        forget : collection of str
            Names of pins to end.
        keep_nbytes : int, optional
            Delete the least recently used artifacts first, and no more once the others take at most these bytes.
        """

    @abstractmethod
    def touch(self, refs: Iterable[str]) -> None:
        """Record that artifacts were used now, where that is cheap and allowed; else they count as used when put."""

    @abstractmethod
    def free_nbytes(self) -> int | None:
        """Return the bytes that can still be written; None if there is no limit that is known."""

    @abstractmethod
    def release(self, refs: Iterable[str]) -> int:
        """Delete those of the artifacts that no pin reaches, whatever their age; return their number."""

    @abstractmethod
    def usage(self) -> dict[str, TaskUsage]:
        """Return the number of artifacts and bytes of each task."""
