"""Artifacts on every kind of store: what is put is read, described and listed, once for each recipe."""

import pickle

import numpy as np
import pytest

from moseg.schemas.errors import InputError, MissingArtifactError, StoreError
from moseg.schemas.recipes import Recipe
from moseg.store import ArtifactStore, PutOutcome, open_store

ABSENT = "toy/" + "f" * 64


def test_store_has_the_interface(store):
    assert isinstance(store, ArtifactStore)


def test_has_only_what_was_put(store, ref):
    assert store.has(ref)
    assert not store.has(ABSENT)


def test_present_returns_the_stored_references(store, ref):
    assert store.present([ABSENT, ref, ref]) == {ref}
    assert store.present([]) == set()


def test_read_returns_the_bytes_that_were_put(store, ref, toy):
    for name, array in toy.arrays.items():
        found = store.read(ref, name)
        assert found.dtype == array.dtype and found.shape == array.shape
        assert found.tobytes() == array.tobytes()


def test_read_returns_a_copy(store, ref, toy):
    store.read(ref, "masks")[...] = 0
    assert store.read(ref, "masks").tobytes() == toy.masks.tobytes()


def test_put_does_not_change_its_input(store, toy):
    array = toy.masks.copy()
    array.flags.writeable = False
    store.put(toy.recipe, {"masks": array}, dims={"masks": toy.dims["masks"]})
    assert np.array_equal(array, toy.masks)


@pytest.mark.parametrize(("start", "stop"), [(0, 4), (1, 3), (3, 4), (2, 2), (0, 0), (4, 4)])
@pytest.mark.parametrize("name", ["masks", "scores"])
def test_read_rows_is_a_slice_of_read(store, ref, toy, name, start, stop):
    assert store.read_rows(ref, name, start, stop).tobytes() == toy.arrays[name][start:stop].tobytes()


@pytest.mark.parametrize(("start", "stop"), [(-1, 2), (3, 2), (0, 5)])
def test_rows_outside_the_array_are_bad_input(store, ref, start, stop):
    with pytest.raises(InputError, match="rows"):
        store.read_rows(ref, "masks", start, stop)


def test_manifest_describes_the_contents_and_their_origin(store, ref, toy):
    manifest = store.manifest(ref)
    assert manifest.key == toy.recipe.key and manifest.recipe == toy.recipe and manifest.recipe.ref == ref
    assert manifest.array("masks").shape == toy.masks.shape
    assert manifest.array("masks").dims == toy.dims["masks"]
    assert manifest.array("scores").dtype == "<f8"
    assert manifest.seconds == 0.25
    assert manifest.nbytes == sum(file.nbytes for file in manifest.files)
    assert {"python", "numpy", "zarr"} <= manifest.versions.keys()
    assert store.attributes(ref) == {"count": 7}


def test_artifact_without_arrays_keeps_its_attributes(store):
    recipe = Recipe(task="score", version=1)
    attributes = {"F": 0.1 + 0.2, "big": 2**60, "names": ["a", None, True], "nested": {"x": -0.0}}
    store.put(recipe, {}, attributes, dims={})
    assert repr(store.attributes(recipe.ref)) == repr(attributes)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), {1, 2}, np.float64(1.0), {1: 2}])
def test_attributes_that_json_cannot_represent_are_refused(store, toy, value):
    with pytest.raises((TypeError, ValueError)):
        store.put(toy.recipe, toy.arrays, {"value": value}, dims=toy.dims)
    assert not store.has(toy.recipe.ref)


def test_put_twice_keeps_the_first(store, ref, toy):
    created = store.manifest(ref).created
    other = toy.arrays | {"masks": toy.masks + 1}
    assert store.put(toy.recipe, other, {"count": 8}, dims=toy.dims) is PutOutcome.LOST_RACE
    assert store.read(ref, "masks").tobytes() == toy.masks.tobytes()
    assert store.manifest(ref).created == created


def test_put_that_loses_the_race_at_the_last_moment_is_a_success(store, ref, toy, monkeypatch):
    monkeypatch.setattr(type(store), "has", lambda self, ref: False)
    assert store.put(toy.recipe, toy.arrays | {"masks": toy.masks + 1}, dims=toy.dims) is PutOutcome.LOST_RACE
    assert store.read(ref, "masks").tobytes() == toy.masks.tobytes()
    assert [result.is_intact for result in store.verify()] == [True]


def test_every_array_has_axis_names(store, toy):
    with pytest.raises(StoreError, match="axis names"):
        store.put(toy.recipe, toy.arrays)


@pytest.mark.parametrize(
    "array", [np.array(["a"]), np.array([None]), np.array(["2020"], dtype="M8[s]"), np.zeros(1, np.longdouble)]
)
def test_dtypes_without_portable_bytes_are_refused(store, toy, array):
    with pytest.raises(StoreError, match="dtype"):
        store.put(toy.recipe, {"x": array}, dims={"x": ("object",)})


def test_a_chunk_over_two_gibibytes_is_refused(store, toy):
    with pytest.raises(StoreError, match="too large"):
        store.put(toy.recipe, {"x": np.broadcast_to(np.uint8(0), 2**31)}, dims={"x": ("object",)})


@pytest.mark.parametrize(
    "dims", [{}, {"x": ("a",)}, {"x": ("a", "b"), "y": ("a",)}, {"masks": ("frame",), "scores": ("object",)}]
)
def test_axis_names_must_fit_the_arrays(store, toy, dims):
    with pytest.raises(StoreError, match="axis names"):
        store.put(toy.recipe, toy.arrays, dims=dims)


def test_absent_artifact_is_a_key_error(store):
    for read in (store.manifest, store.attributes, lambda ref: store.read(ref, "masks")):
        with pytest.raises(MissingArtifactError, match="f" * 64):
            read(ABSENT)
    with pytest.raises(KeyError):
        list(store.verify([ABSENT]))


def test_the_error_for_an_absent_array_lists_the_stored_ones(store, ref):
    with pytest.raises(StoreError, match="masks, scores"):
        store.read(ref, "flow")


@pytest.mark.parametrize("bad", ["", "toy", "toy/0", "../" + "0" * 64, "toy/" + "A" * 64, "toy/" + "0" * 64 + "\n"])
def test_malformed_reference_is_bad_input(store, bad):
    for call in (store.has, store.manifest, store.remove, lambda ref: store.quarantine(ref, "no reason")):
        with pytest.raises(InputError, match="reference"):
            call(bad)


def test_refs_are_listed_in_order_and_by_task(store, ref):
    others = [Recipe(task=task, version=number) for task in ("apple", "zoo") for number in range(3)]
    for recipe in others:
        store.put(recipe, {}, dims={})
    assert list(store.refs()) == sorted([ref, *(recipe.ref for recipe in others)])
    assert list(store.refs("zoo")) == sorted(recipe.ref for recipe in others[3:])
    assert list(store.refs("nothing")) == []


def test_usage_counts_artifacts_and_bytes_by_task(store, ref):
    store.put(Recipe(task="apple", version=1), {}, dims={})
    usage = store.usage()
    assert usage.keys() == {"apple", "toy"}
    assert usage["toy"].num_artifacts == 1
    assert usage["toy"].nbytes > store.manifest(ref).nbytes


def test_removed_artifact_is_gone_and_can_be_put_again(store, ref, toy):
    assert store.remove(ref) and not store.remove(ref)
    assert not store.has(ref) and list(store.refs()) == []
    assert store.put(toy.recipe, toy.arrays, dims=toy.dims) is PutOutcome.COMMITTED


def test_store_can_be_pickled(store, ref, toy):
    copy = pickle.loads(pickle.dumps(store))
    assert copy.read(ref, "masks").tobytes() == toy.masks.tobytes()


def test_another_handle_sees_the_artifact(store, place, ref):
    assert place.open().has(ref)


def test_the_url_opens_the_same_store(store, ref):
    assert open_store(store.url, create=False).has(ref)


def test_touch_is_no_error_without_an_artifact(store, ref):
    store.touch([ref, ABSENT])
    assert list(store.refs()) == [ref]
