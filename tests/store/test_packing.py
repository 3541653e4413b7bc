"""Packs: archives that any reader of ZIP opens, and of which every byte follows from the files."""

import io
import zipfile

import numpy as np
import pytest
import zarr

from moseg.schemas.manifests import FileEntry
from moseg.schemas.recipes import Recipe
from moseg.store.packing import MAX_FILES, is_packable, pack, pack_nbytes, places

FILES = {"x/c.0": b"\0\1\2", "x/zarr.json": b"{}", "zarr.json": b"", "é/c": bytes(1000)}
ENTRIES = [FileEntry(path=path, nbytes=len(content)) for path, content in FILES.items()]


def test_a_reader_of_zip_finds_the_files_unchanged():
    with zipfile.ZipFile(io.BytesIO(pack(FILES))) as archive:
        assert archive.testzip() is None
        assert {name: archive.read(name) for name in archive.namelist()} == FILES


def test_sizes_and_places_follow_from_the_list_of_files():
    packed = pack(FILES)
    assert len(packed) == pack_nbytes(ENTRIES)
    found = {path: packed[start : start + nbytes] for path, (start, nbytes) in places(ENTRIES).items()}
    assert found == FILES


def test_too_many_files_are_not_packed():
    assert is_packable(dict.fromkeys(map(str, range(MAX_FILES)), b""))
    assert not is_packable(dict.fromkeys(map(str, range(MAX_FILES + 1)), b""))


@pytest.mark.parametrize("num_arrays", [0, 1, 5])
def test_an_artifact_takes_two_files_and_is_a_zarr_group(store, num_arrays):
    arrays = {f"x{number}": np.full((3, 4, 5), number, np.float32) for number in range(num_arrays)}
    recipe = Recipe(task="toy", version=1)
    store.put(recipe, arrays, dims=dict.fromkeys(arrays, ("frame", "y", "x")))
    files = [path.name for path in (store.root / "objects").rglob("*") if path.is_file()]
    assert sorted(files) == ["arrays.zip", "manifest.json"]
    group = zarr.open_group(store.place(recipe.ref), mode="r")
    assert sorted(group) == sorted(arrays)
    for name, array in arrays.items():
        assert np.array_equal(group[name][1:], array[1:])
