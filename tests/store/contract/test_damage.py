"""Damage to stored bytes on every kind of store: none of it is read, and `verify` finds all of it."""

from functools import partial

import numpy as np
import pytest

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.schemas.recipes import Recipe
from moseg.store import PutOutcome, reading
from moseg.store.names import MANIFEST


def test_quarantined_artifact_is_a_miss_and_can_be_put_again(store, ref, toy):
    assert store.quarantine(ref, "bad bytes")
    assert not store.quarantine(ref, "bad bytes")
    assert not store.has(ref)
    with pytest.raises(MissingArtifactError):
        store.manifest(ref)
    assert store.put(toy.recipe, toy.arrays, dims=toy.dims) is PutOutcome.COMMITTED


def test_verify_passes_intact_artifacts(store, ref):
    store.put(Recipe(task="apple", version=1), {}, {"a": 1}, dims={})
    assert [(result.ref, result.problem) for result in store.verify(store.refs())] == [
        (ref, None) for ref in store.refs()
    ]


@pytest.mark.parametrize("whole_bytes", [0, 65_536])
def test_a_lost_chunk_is_never_read_as_zeros(store, place, ref, monkeypatch, whole_bytes):
    monkeypatch.setattr(reading, "WHOLE_BYTES", whole_bytes)
    contents = store.export_artifact(ref).files
    chunks = [name for name in contents if "/c" in name]
    assert len(chunks) == 5
    for name in chunks:
        place.damage(store, ref, name, None)
        with pytest.raises(CorruptArtifactError) as caught:
            store.read(ref, name.partition("/")[0])
        assert caught.value.ref == ref
        place.damage(store, ref, name, contents[name])


@pytest.mark.parametrize("whole_bytes", [0, 65_536])
@pytest.mark.parametrize("kept", [0, 0.5])
def test_a_file_that_lost_its_end_is_never_read(store, place, ref, toy, monkeypatch, whole_bytes, kept):
    monkeypatch.setattr(reading, "WHOLE_BYTES", whole_bytes)
    for name in set(place.files(ref)) - {MANIFEST}:
        content = place.read(ref, name)
        place.write(ref, name, content[: int(kept * len(content))])
    with pytest.raises(CorruptArtifactError):
        list(map(partial(store.read, ref), toy.arrays))


def test_read_rows_needs_only_the_chunks_of_those_rows(store, place, ref, toy, monkeypatch):
    monkeypatch.setattr(reading, "WHOLE_BYTES", 0)
    place.damage(store, ref, "masks/c.3.0.0", None)
    assert np.array_equal(store.read_rows(ref, "masks", 0, 3), toy.masks[:3])
    with pytest.raises(CorruptArtifactError):
        store.read_rows(ref, "masks", 2, 4)


def test_damage_to_any_file_is_found(store, place, ref):
    for name in place.files(ref):
        content = place.read(ref, name)
        flipped = bytes([content[0] ^ 1]) + content[1:]
        for damaged in (None, b"", content[:-1], content + b"\0", flipped, bytes(len(content))):
            place.write(ref, name, damaged)
            is_lost = name == MANIFEST and damaged is None
            expected = place.without_manifest if is_lost else [False]
            assert [result.is_intact for result in store.verify()] == expected, (name, damaged)
        place.write(ref, name, content)
    assert [result.is_intact for result in store.verify()] == [True]


def test_checked_read_finds_a_chunk_of_another_artifact(store, place, ref, toy):
    other = Recipe(task="toy", version=3)
    store.put(other, toy.arrays | {"masks": toy.masks[::-1]}, dims=toy.dims)
    place.damage(store, ref, "masks/c.0.0.0", store.export_artifact(other.ref).files["masks/c.0.0.0"])
    with pytest.raises(CorruptArtifactError):
        store.read(ref, "masks", check=True)
    assert store.read(other.ref, "masks", check=True).tobytes() == toy.masks[::-1].tobytes()
