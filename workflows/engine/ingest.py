"""Ingest: files become leaves of the graph, named by the digest of their decoded content.

Decoding is skipped if the same file bytes were decoded before: an `ingest` artifact, keyed by the files' fingerprint,
remembers their leaves. Modification times are never used.
"""

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from moseg.schemas.digests import digest_json, hash_array
from moseg.schemas.errors import MissingArtifactError
from moseg.schemas.recipes import Recipe, leaf_recipe
from moseg.store import ArtifactStore, map_reads
from moseg.workflows.stages.registry import axes_of

INGEST_VERSION = 1

LeafWriter = Callable[[dict[str, np.ndarray], dict], str]
"""A function that takes a leaf's arrays and attributes and returns its reference."""


class IngestJob(NamedTuple):
    """One source to decode into leaves of one kind (the leaf's task name).

    Jobs of one `batch` run one after the other in one process, because they share the work of decoding. Batches of
    cheap jobs, of some milliseconds, share a call too.
    """

    kind: str
    source: Any
    batch: str | None = None
    is_cheap: bool = False

    @property
    def recipe(self) -> Recipe:
        """Recipe under which the outcome is remembered."""
        params = {"kind": self.kind, "fingerprint": self.source.fingerprint()}
        return Recipe(task="ingest", version=INGEST_VERSION, params=params)


def run_ingest(store: ArtifactStore, batch: Sequence[tuple[IngestJob, Recipe]]) -> dict[str, dict]:
    """Decode the sources of a batch, store and remember their leaves, and return that memory by reference."""
    remembered = {}
    for job, recipe in batch:
        started = time.perf_counter()
        attributes = _LEAVES[job.kind](partial(_put_leaf, store, job.kind), job.source)
        # Another process may have remembered the same by now, and a third may be reading it.
        known = _recall(store, recipe.ref)
        if known != attributes:
            if known is not None:
                store.remove(recipe.ref)
            store.put(recipe, {}, attributes, seconds=time.perf_counter() - started)
        remembered[recipe.ref] = attributes
    return remembered


def preview_ingest(job: IngestJob) -> dict:
    """Return what `run_ingest` would return, and store nothing."""
    return _LEAVES[job.kind](partial(_name_leaf, job.kind), job.source)


def recall_ingests(
    store: ArtifactStore, recipes: Sequence[Recipe], read: Callable[[ArtifactStore, str], dict | None] | None = None
) -> dict[str, dict | None]:
    """Return the outcome of earlier ingests of the same bytes, by reference; None if there was none or a leaf is gone.

    `read` returns the memory under a reference, or None if there is none or it is damaged; by default a damaged one
    raises CorruptArtifactError.
    """
    refs = sorted(store.present(recipe.ref for recipe in recipes))
    memories = dict(zip(refs, map_reads(store, partial(read or _recall, store), refs), strict=True))
    known = {ref: memory for ref, memory in memories.items() if memory is not None}
    leaves = store.present({leaf for memory in known.values() for leaf in memory["leaves"]})
    found: dict[str, dict | None] = {recipe.ref: None for recipe in recipes}
    return found | {ref: memory for ref, memory in known.items() if leaves.issuperset(memory["leaves"])}


def _recall(store: ArtifactStore, ref: str) -> dict | None:
    """Return the memory under a reference, or None if there is none any more."""
    try:
        return store.attributes(ref)
    except MissingArtifactError:
        return None


def _per_item(name: str) -> Callable[[LeafWriter, Any], dict]:
    """Return a function that stores one leaf for each array of the source."""

    def ingest(leaf: LeafWriter, source) -> dict:
        leaves, shape = [], None
        for array in source.read():
            shape = list(array.shape[:2])
            leaves.append(leaf({name: array}, {}))
        return {"leaves": leaves, "shape": shape}

    return ingest


def _masks(leaf: LeafWriter, source) -> dict:
    """Store one leaf for all masks of a sequence, with the indices of their frames."""
    indices, masks = [], []
    for index, mask in source.read():
        indices.append(int(index))
        masks.append(mask)
    labels = sorted({int(label) for mask in masks for label in np.flatnonzero(np.bincount(mask.ravel()))} - {0})
    # Each mask is freed when it is copied: two copies of all would be twice as large.
    stack = np.empty((len(masks), *masks[0].shape), np.result_type(*masks))
    for row in reversed(range(len(masks))):
        stack[row] = masks.pop()
    ref = leaf({"masks": stack}, {"indices": indices})
    return {"leaves": [ref], "labels": labels, "shape": list(stack.shape[1:])}


def _tracks(leaf: LeafWriter, source) -> dict:
    points, visible = source.read()
    return {"leaves": [leaf({"points": points, "visible": visible}, {})]}


def _labelled_points(leaf: LeafWriter, source) -> dict:
    """Store one leaf for the labelled points of a sequence, with the size of the labelled frames."""
    arrays = source.read()._asdict()
    size = list(arrays.pop("size"))
    labels = sorted({int(label) for label in arrays["labels"]} - {0})
    return {"leaves": [leaf(arrays, {"size": size})], "labels": labels}


def _labels(leaf: LeafWriter, source) -> dict:
    """Store one leaf for the labels of trajectories; 0 is no label and does not count as one."""
    labels = source.read()
    return {"leaves": [leaf({"labels": labels}, {})], "labels": np.unique(labels[labels > 0]).tolist()}


def _put_leaf(store: ArtifactStore, kind: str, arrays: dict[str, np.ndarray], attributes: dict) -> str:
    digests = _digests(arrays)
    recipe = _content_recipe(kind, digests, attributes)
    if not store.has(recipe.ref):
        store.put(recipe, arrays, attributes, dims=axes_of(kind, arrays), digests=digests)
    return recipe.ref


def _name_leaf(kind: str, arrays: dict[str, np.ndarray], attributes: dict) -> str:
    return _content_recipe(kind, _digests(arrays), attributes).ref


def _digests(arrays: dict[str, np.ndarray]) -> dict[str, str]:
    return {name: hash_array(array) for name, array in sorted(arrays.items())}


def _content_recipe(kind: str, digests: dict[str, str], attributes: dict) -> Recipe:
    return leaf_recipe(kind, digest_json("leaf", [digests, attributes]))


def _motion_weights(leaf: LeafWriter, source) -> dict:
    return {"leaves": [leaf({"onnx": source.read()}, {})]}


_LEAVES: dict[str, Callable[[LeafWriter, Any], dict]] = {
    "frame": _per_item("image"),
    "annotation": _masks,
    "labelled_points": _labelled_points,
    "given_masks": _masks,
    "given_depth": _per_item("inverse_depth"),
    "given_flow": _per_item("flow"),
    "given_tracks": _tracks,
    "motion_weights": _motion_weights,
    "trajectories": _tracks,
    "trajectory_labels": _labels,
}
