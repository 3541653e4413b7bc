"""The part of a store that is the same on every backend: what an artifact is."""

import platform
import time
from collections import Counter
from collections.abc import Mapping
from datetime import UTC, datetime

import numpy as np
from pydantic import JsonValue

from moseg.schemas.digests import canonical_json
from moseg.schemas.errors import StoreError
from moseg.schemas.manifests import FileEntry, Manifest
from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import collection, copying, pins, reading, verification
from moseg.store.backend import Backend
from moseg.store.codec import METADATA, encode_group
from moseg.store.outcomes import PutOutcome, TaskUsage
from moseg.store.packing import PACK
from moseg.store.provenance import library_versions
from moseg.store.sealing import digest_metadata


class BackendStore(Backend):
    """Base class of stores: implements `ArtifactStore` by the file operations that each `Backend` defines."""

    # functions whose first argument is the store
    manifest = reading.read_manifest
    read = reading.read_array
    read_rows = reading.read_rows
    verify = verification.verify
    export_artifact = copying.export_artifact
    import_artifact = copying.import_artifact
    remove = collection.remove
    gc = collection.collect
    release = collection.release
    pin = pins.pin
    unpin = pins.unpin
    pinned = pins.pinned
    pin_of = pins.pin_of

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.url!r})"

    def put(
        self,
        recipe: Recipe,
        arrays: Mapping[str, np.ndarray],
        attributes: Mapping[str, JsonValue] | None = None,
        seconds: float = 0.0,
        dims: Mapping[str, tuple[str, ...]] | None = None,
        digests: Mapping[str, str] | None = None,
    ) -> PutOutcome:
        if self.has(recipe.ref):
            return PutOutcome.LOST_RACE
        axes = _check_dims(arrays, dims or {})
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
            created=datetime.now(UTC).isoformat(),
            host=platform.node(),
            versions=library_versions(),
        )
        metadata = {path: digest_metadata(files[path]) for path in files if path.rpartition("/")[2] == METADATA}
        return copying.commit_packed(self, manifest, metadata, files)

    def attributes(self, ref: str) -> dict[str, JsonValue]:
        return self.manifest(ref).attributes

    def quarantine(self, ref: str, reason: str) -> bool:
        content = canonical_json({"ref": ref, "reason": reason, "time": time.time()})
        return self.move_to_quarantine(ref, content + b"\n")

    def place(self, ref: str) -> str:
        sealed = reading.read_sealed(self, ref)
        place = self.payload_place(ref, sealed.payload)
        return f"zip::{place}/{PACK}" if sealed.is_packed else place

    def usage(self) -> dict[str, TaskUsage]:
        counts, nbytes = Counter(), Counter()
        for ref, size in self.nbytes(list(self.refs())).items():
            task, _ = split_ref(ref)
            counts[task] += 1
            nbytes[task] += size
        return {task: TaskUsage(counts[task], nbytes[task]) for task in counts}


def _check_dims(arrays: Mapping[str, np.ndarray], dims: Mapping[str, tuple[str, ...]]) -> Mapping[str, tuple[str, ...]]:
    found = {name: array.ndim for name, array in arrays.items()}
    expected = {name: len(axes) for name, axes in dims.items()}
    if found != expected or not all(name.isidentifier() for name in arrays):
        raise StoreError("axis names do not fit the arrays", got=found, expected=expected)
    return dims
