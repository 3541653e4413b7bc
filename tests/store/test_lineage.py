"""Ancestors and descendants of artifacts."""

import numpy as np
import pytest
import zarr

from moseg.store.lineage import State, ancestry, descendants


@pytest.fixture
def family(store, put_toy):
    """Put two leaves, a child of both, a grandchild of the child and a leaf, and a separate artifact, by name."""
    refs = {"left": put_toy(store, 0), "right": put_toy(store, 1), "apart": put_toy(store, 9)}
    refs["child"] = put_toy(store, 2, {"pair": (refs["left"], refs["right"])})
    refs["grandchild"] = put_toy(store, 3, {"child": refs["child"], "leaf": refs["left"]})
    return refs


def _depths(relatives, family):
    names = {ref: name for name, ref in family.items()}
    return [(names[relative.ref], relative.depth) for relative in relatives]


def test_ancestry_holds_the_artifact_and_its_ancestors_nearest_first(store, family):
    found = list(ancestry(store, [family["grandchild"]]))
    assert _depths(found, family) == [("grandchild", 0), ("child", 1), ("left", 1), ("right", 2)]
    assert all(relative.state == State.STORED for relative in found)
    assert [relative.recipe for relative in found] == [store.manifest(relative.ref).recipe for relative in found]
    assert [relative.nbytes for relative in found] == [store.manifest(relative.ref).nbytes for relative in found]


def test_the_ancestry_of_several_names_each_once_at_its_min_depth(store, family):
    found = ancestry(store, [family["child"], family["grandchild"], family["child"]])
    assert _depths(found, family) == [("child", 0), ("grandchild", 0), ("left", 1), ("right", 1)]


def test_descendants_are_ordered_nearest_first(store, family):
    assert sorted(_depths(descendants(store, family["left"]), family)) == [("child", 1), ("grandchild", 1)]
    assert _depths(descendants(store, family["right"]), family) == [("child", 1), ("grandchild", 2)]
    assert list(descendants(store, family["grandchild"])) == []
    assert list(descendants(store, family["apart"])) == []


def test_a_missing_artifact_ends_the_ancestry_and_is_named(store, family):
    store.remove(family["child"])
    found = list(ancestry(store, [family["grandchild"]]))
    assert _depths(found, family) == [("grandchild", 0), ("child", 1), ("left", 1)]
    assert [relative.state for relative in found] == [State.STORED, State.ABSENT, State.STORED]
    assert found[1].recipe is None and found[1].nbytes == 0


def test_a_damaged_manifest_ends_the_ancestry_and_is_named(store, family):
    ref = family["child"]
    manifest = store.root / "objects" / ref.replace("/", f"/{ref.partition('/')[2][:2]}/") / "manifest.json"
    manifest.write_bytes(manifest.read_bytes().replace(b"toy", b"top"))
    damaged = list(ancestry(store, [family["grandchild"]]))[1]
    assert (damaged.ref, damaged.state) == (ref, State.DAMAGED)
    assert "seal" in damaged.problem
    assert _depths(descendants(store, family["right"]), family) == []


def test_descendants_of_a_removed_artifact_are_found(store, family):
    store.remove(family["right"])
    assert _depths(descendants(store, family["right"]), family) == [("child", 1), ("grandchild", 2)]


def test_descendants_read_every_manifest_once(store, family):
    read = []
    list(descendants(store, family["left"], on_read=lambda: read.append(1)))
    assert len(read) == len(family)


def test_the_place_of_an_artifact_opens_in_zarr(store, family):
    group = zarr.open_group(store.place(family["child"]), mode="r")
    np.testing.assert_array_equal(group["x"][:], store.read(family["child"], "x"))
