"""What an artifact is, on whatever backend its bytes lie."""

import platform
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from pydantic import JsonValue

from moseg.schemas.arrays import check_arrays
from moseg.schemas.digests import canonical_json
from moseg.schemas.errors import StoreError
from moseg.schemas.manifests import FileEntry, Manifest
from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import collection, copying, pins, reading, verification
from moseg.store.backend import Backend
from moseg.store.codec import METADATA, encode_group
from moseg.store.outcomes import GcReport, Pin, PutOutcome, StoredArtifact, TaskUsage, VerifyResult
from moseg.store.provenance import library_versions, utc_now
from moseg.store.sealing import digest_metadata, seal


class BackendStore:
    """Artifacts on a backend; see `moseg.store.protocol.ArtifactStore` for what each method promises."""

    def __init__(self, backend: Backend):
        self._backend = backend

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.url!r})"

    @property
    def url(self) -> str:
        """What `store.open_store` takes to open the same store in another process."""
        return self._backend.url

    def has(self, ref: str) -> bool:
        """Whether the artifact is stored: one lookup."""
        return self._backend.has(ref)

    def present(self, refs: Iterable[str]) -> set[str]:
        """Those of the references that are stored."""
        return self._backend.present(refs)

    def put(
        self,
        recipe: Recipe,
        arrays: Mapping[str, np.ndarray],
        attributes: Mapping[str, JsonValue] | None = None,
        seconds: float = 0.0,
        dims: Mapping[str, tuple[str, ...]] | None = None,
        digests: Mapping[str, str] | None = None,
    ) -> PutOutcome:
        """Store one artifact.

        Parameters
        ----------
        arrays : dict of ndarray
            By name; checked against the task's layout in `moseg.schemas.arrays`.
        attributes : dict of JSON values
            Results that are not arrays; finite and exact, as in a recipe.
        seconds : float
            Time that the task took.
        dims : dict of axis names, optional
            Axis names of each array, for a task without a layout.
        digests : dict of str, optional
            `hash_array` of arrays of which the caller has it.

        Raises
        ------
        StoreError
            Arrays that are not the task's, or a backend that refuses.
        TypeError, ValueError
            Attributes that JSON does not keep exactly.
        """
        if self.has(recipe.ref):
            return PutOutcome.LOST_RACE
        axes = check_arrays(recipe.task, dict(arrays)) if dims is None else _check_dims(arrays, dims)
        attributes = dict(attributes or {})
        canonical_json(attributes)
        files, entries = encode_group(arrays, axes, digests)
        manifest = Manifest(
            key=recipe.key,
            recipe=recipe,
            arrays=entries,
            attributes=attributes,
            files=tuple(FileEntry(path=path, nbytes=content.nbytes) for path, content in files.items()),
            seconds=seconds,
            nbytes=sum(content.nbytes for content in files.values()),
            created=utc_now(),
            host=platform.node(),
            versions=library_versions(),
        )
        metadata = {path: digest_metadata(files[path]) for path in files if path.rpartition("/")[2] == METADATA}
        return self._backend.commit(recipe.ref, files, lambda payload: seal(manifest, metadata, payload))

    def manifest(self, ref: str) -> Manifest:
        """What the artifact holds and how it came to be."""
        return reading.read_manifest(self._backend, ref)

    def attributes(self, ref: str) -> dict[str, JsonValue]:
        """Results that are not arrays."""
        return self.manifest(ref).attributes

    def read(self, ref: str, name: str, check: bool = False) -> np.ndarray:
        """One whole array; with `check` its digest too is compared, not only checksums."""
        return reading.read_array(self._backend, ref, name, check)

    def read_rows(self, ref: str, name: str, start: int, stop: int) -> np.ndarray:
        """Rows ``start`` to ``stop`` (exclusive) of the leading axis."""
        return reading.read_rows(self._backend, ref, name, start, stop)

    def refs(self, task: str | None = None) -> Iterator[str]:
        """References of all artifacts, or of one task's, in order."""
        return self._backend.refs(task)

    def verify(self, refs: Iterable[str] | None = None) -> Iterator[VerifyResult]:
        """Compare every byte with what the manifests name."""
        return verification.verify(self._backend, refs)

    def export(self, ref: str) -> StoredArtifact:
        """An artifact with all its files, every byte compared with what its manifest names."""
        return copying.export(self._backend, ref)

    def adopt(self, artifact: StoredArtifact) -> PutOutcome:
        """Store what another store exported, as it was made there."""
        return copying.adopt(self._backend, artifact)

    def quarantine(self, ref: str, reason: str) -> bool:
        """Take an artifact out of service and keep its bytes aside; False where somebody else already did."""
        content = canonical_json({"ref": ref, "reason": reason, "time": time.time()})
        return self._backend.quarantine(ref, content + b"\n")

    def place(self, ref: str) -> str:
        """Folder or URL of the Zarr group, for other programs to read."""
        return self._backend.place(ref, reading.read_sealed(self._backend, ref).payload)

    def remove(self, ref: str) -> bool:
        """Delete an artifact; False where there is none."""
        return collection.remove(self._backend, ref)

    def pin(self, run_id: str, refs: Iterable[str], lease_seconds: float | None = None) -> None:
        """Keep references from `gc`: until `unpin`, or with a lease while this process runs and the lease lasts."""
        pins.pin(self._backend, run_id, refs, lease_seconds)

    def unpin(self, run_id: str) -> bool:
        """End a run's pin; False where there is none."""
        return pins.unpin(self._backend, run_id)

    def pinned(self) -> dict[str, Pin]:
        """The pins that hold now, by run."""
        return pins.pinned(self._backend)

    def pin_of(self, run_id: str) -> Pin | None:
        """A run's pin where it holds now."""
        return pins.pin_of(self._backend, run_id)

    def append_log(self, run_id: str, lines: bytes) -> None:
        """Add whole lines to a run's log."""
        self._backend.append_log(run_id, lines)

    def read_log(self, run_id: str) -> list[bytes]:
        """The lines of a run's log, those of each process in order."""
        return self._backend.read_log(run_id)

    def logs(self) -> dict[str, float]:
        """Runs that left a log, with the time at which it last grew, seconds since the epoch."""
        return self._backend.logs()

    def remove_log(self, run_id: str) -> bool:
        """Delete a run's log; False where there is none."""
        return self._backend.remove_log(run_id)

    def gc(self, *, is_dry: bool = True, grace_seconds: float = 86_400.0) -> GcReport:
        """Delete what no pin reaches and is older than the grace period; by default only say what that is."""
        return collection.collect(self._backend, is_dry=is_dry, grace_seconds=grace_seconds)

    def usage(self) -> dict[str, TaskUsage]:
        """Artifacts and bytes of each task."""
        counts, nbytes = Counter(), Counter()
        for ref, size in self._backend.nbytes(list(self.refs())).items():
            task, _ = split_ref(ref)
            counts[task] += 1
            nbytes[task] += size
        return {task: TaskUsage(counts[task], nbytes[task]) for task in counts}


def _check_dims(arrays: Mapping[str, np.ndarray], dims: Mapping[str, tuple[str, ...]]) -> Mapping[str, tuple[str, ...]]:
    found = {name: array.ndim for name, array in arrays.items()}
    expected = {name: len(axes) for name, axes in dims.items()}
    if found != expected or not all(name.isidentifier() for name in arrays):
        raise StoreError("arrays that their axis names do not fit", got=found, expected=expected)
    return dims
