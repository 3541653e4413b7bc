"""Damage to stored bytes: none is returned, and `verify` finds all of it."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import zarr

from moseg.schemas.digests import digest_array, hash_array
from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import LocalStore, copying

RECIPE = Recipe(task="toy", version=1, params={"threshold": 0.5})
ARRAY = np.arange(2 * 3 * 2, dtype=np.int16).reshape(2, 3, 2)


@pytest.fixture
def folder(store: LocalStore) -> Path:
    store.put(RECIPE, {"x": ARRAY}, {"note": "é"}, dims={"x": ("frame", "y", "x")})
    return folder_of(store, RECIPE.ref)


def folder_of(store: LocalStore, ref: str) -> Path:
    task, key = split_ref(ref)
    return store.root / "objects" / task / key[:2] / key


def write_at(path: Path, position: int, byte: int) -> None:
    with path.open("r+b") as file:
        file.seek(position)
        file.write(bytes([byte]))


def problem(store: LocalStore) -> str | None:
    (result,) = store.verify()
    return result.problem


def test_every_flipped_byte_is_found_and_never_returned(store, folder):
    paths = [path for path in folder.rglob("*") if path.is_file()]
    assert sorted(path.name for path in paths) == ["arrays.zip", "manifest.json"]
    for path in paths:
        content = path.read_bytes()
        for position in range(len(content)):
            write_at(path, position, content[position] ^ 0x10)
            assert problem(store) is not None, (path.name, position)
            if position % 4 == 0:
                with pytest.raises(CorruptArtifactError) as caught:
                    store.read(RECIPE.ref, "x")
                assert caught.value.ref == RECIPE.ref
            write_at(path, position, content[position])
    assert problem(store) is None


@pytest.mark.parametrize("name", ["extra.txt", "x/c.2.0.0", "x/extra", "y/zarr.json"])
def test_an_added_file_is_found(store, folder, name):
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_bytes(b"")
    assert "wrong file" in problem(store)


def test_a_link_in_place_of_a_file_is_found(store, folder, tmp_path):
    shutil.move(folder / "arrays.zip", tmp_path / "elsewhere")
    (folder / "arrays.zip").symlink_to(tmp_path / "elsewhere")
    assert "wrong file" in problem(store)


def test_a_folder_in_place_of_a_file_is_found(store, folder):
    (folder / "arrays.zip").unlink()
    (folder / "arrays.zip").mkdir()
    assert problem(store) is not None
    with pytest.raises(CorruptArtifactError):
        store.read(RECIPE.ref, "x")


def test_an_artifact_under_another_key_is_found(store, folder):
    other = "toy/" + "ab" * 32
    shutil.copytree(folder, folder_of(store, other))
    with pytest.raises(CorruptArtifactError, match="another artifact"):
        store.read(other, "x")
    assert {result.ref: result.is_intact for result in store.verify()} == {RECIPE.ref: True, other: False}


def test_a_manifest_that_is_not_json_has_a_one_line_error(store, folder):
    (folder / "manifest.json").write_bytes(b"\xff\x00not json\n")
    with pytest.raises(CorruptArtifactError, match="seal") as caught:
        store.manifest(RECIPE.ref)
    assert "\n" not in str(caught.value) and RECIPE.ref in str(caught.value)


def test_an_empty_folder_is_damage_not_an_artifact(store, folder):
    shutil.rmtree(folder)
    folder.mkdir()
    with pytest.raises(CorruptArtifactError):
        store.manifest(RECIPE.ref)
    assert problem(store) is not None


def test_damage_is_quarantined_with_its_bytes_and_reason_and_can_be_put_again(store, folder):
    (folder / "arrays.zip").write_bytes(b"junk")
    assert store.quarantine(RECIPE.ref, "file of another length")
    (slot,) = (store.root / "quarantine").iterdir()
    assert (slot / "artifact/arrays.zip").read_bytes() == b"junk"
    reason = json.loads((slot / "reason.json").read_text())
    assert (reason["ref"], reason["reason"]) == (RECIPE.ref, "file of another length")
    store.put(RECIPE, {"x": ARRAY}, dims={"x": ("frame", "y", "x")})
    assert np.array_equal(store.read(RECIPE.ref, "x"), ARRAY)


def test_a_second_quarantine_leaves_nothing_behind(store, folder):
    assert store.quarantine(RECIPE.ref, "first")
    assert not store.quarantine(RECIPE.ref, "second")
    assert len(list((store.root / "quarantine").iterdir())) == 1


def test_an_artifact_removed_while_it_is_verified_is_skipped(store, folder, put_toy):
    refs = sorted([RECIPE.ref, put_toy(store, 1)])
    results = store.verify()
    assert next(results).ref == refs[0]
    store.remove(refs[1])
    assert list(results) == []


def test_plain_zarr_would_read_the_lost_chunk_as_zeros(store, monkeypatch):
    monkeypatch.setattr(copying, "is_packable", lambda files: False)
    store.put(RECIPE, {"x": ARRAY}, dims={"x": ("frame", "y", "x")})
    folder = folder_of(store, RECIPE.ref)
    (folder / "x/c.0.0.0").unlink()
    assert not zarr.open_group(folder, mode="r")["x"][0].any()
    with pytest.raises(CorruptArtifactError):
        store.read(RECIPE.ref, "x")


def test_a_vanished_artifact_is_missing_not_corrupt(store, folder):
    shutil.rmtree(folder)
    with pytest.raises(MissingArtifactError):
        store.read(RECIPE.ref, "x")


def test_arrays_digested_by_an_earlier_version_are_verified(store, put_toy, monkeypatch):
    monkeypatch.setattr("moseg.store.codec.hash_array", lambda array: digest_array("array", array))
    ref = put_toy(store)
    monkeypatch.setattr("moseg.store.codec.hash_array", lambda array: digest_array("other", array))
    wrong = put_toy(store, 1)
    assert [result.is_intact for result in store.verify([ref, wrong])] == [True, False]


def test_a_digest_given_to_put_is_verified(store):
    array = np.arange(3.0)
    digests = {"x": hash_array(array)}
    for number, given in enumerate((array, array + 1)):
        recipe = Recipe(task="toy", version=1, params={"number": number})
        store.put(recipe, {"x": given}, dims={"x": ("a",)}, digests=digests)
        assert store.manifest(recipe.ref).array("x").digest == digests["x"]
        assert [result.is_intact for result in store.verify([recipe.ref])] == [number == 0]
