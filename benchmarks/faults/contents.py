"""Contents of a store, compared between runs, before and after a fault."""

import hashlib
from typing import NamedTuple

from moseg.schemas.errors import CorruptArtifactError, StoreChoiceError
from moseg.schemas.manifests import Manifest
from moseg.store import open_store


class Contents(NamedTuple):
    """Contents of a store.

    Attributes
    ----------
    results : dict
        By reference, the digest of each array's decoded bytes as a task reads them, and the results that are not
        arrays; artifacts that the store refuses to return are left out.
    written : dict
        By reference, what changes when an artifact is written again: when it was computed, and in how many seconds.
    leaves : set of references
        Artifacts from outside; runs do not count these as computed.
    problems : dict of str
        The damage that `verify` found, by reference.
    """

    results: dict[str, tuple[dict[str, str], dict]]
    written: dict[str, tuple[str, float]]
    leaves: frozenset[str]
    problems: dict[str, str]

    def num_computed(self, before: "Contents | None" = None) -> int:
        """Return how many artifacts a run must compute to get here, from `before` or from nothing."""
        had = self.leaves if before is None else self.leaves | before.results.keys()
        return len(self.results.keys() - had)

    def rewritten(self, before: "Contents") -> list[str]:
        """Return the references in `before` whose artifacts were written again since, or lost."""
        return sorted(ref for ref, written in before.written.items() if self.written.get(ref) != written)


def read_contents(url: str) -> Contents:
    """Read every artifact of a store, and verify it; return empty contents if there is no store yet."""
    try:
        store = open_store(url, create=False)
    except StoreChoiceError:
        # Not made yet, or being made.
        return Contents({}, {}, frozenset(), {})
    results, written, leaves = {}, {}, set()
    for ref in store.refs():
        try:
            manifest = store.manifest(ref)
            arrays = {entry.name: _digest(store.read(ref, entry.name)) for entry in manifest.arrays}
        except CorruptArtifactError:
            # `verify` must find it too.
            continue
        results[ref] = arrays, manifest.attributes
        written[ref] = manifest.created, manifest.seconds
        if _is_leaf(manifest):
            leaves.add(ref)
    problems = {result.ref: result.problem for result in store.verify() if not result.is_intact}
    return Contents(results, written, frozenset(leaves), problems)


def count_artifacts(url: str) -> int:
    """Return how many artifacts are visible now; 0 if there is no store yet."""
    try:
        return sum(1 for _ in open_store(url, create=False).refs())
    except StoreChoiceError:
        return 0


def _digest(array) -> str:
    return hashlib.sha256(f"{array.dtype.str} {array.shape} ".encode() + array.tobytes()).hexdigest()


def _is_leaf(manifest: Manifest) -> bool:
    return not manifest.recipe.inputs and manifest.recipe.params.keys() == {"content"}
