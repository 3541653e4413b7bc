"""Places that can be a store, and values of ``--store``."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pytest

from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore, PutOutcome, copying, open_store
from moseg.store.local import moves

NOBODY = 65534


def test_new_nested_folder_becomes_a_store(tmp_path):
    LocalStore(tmp_path / "a" / "b")
    assert (tmp_path / "a/b/moseg-store.json").is_file()
    LocalStore(tmp_path / "a" / "b", create=False)


def test_a_marker_that_another_process_is_writing_is_accepted(tmp_path):
    (tmp_path / ".moseg-store.json.0123").write_bytes(b"")
    LocalStore(tmp_path)


def test_a_folder_with_other_files_is_refused_and_not_changed(tmp_path):
    (tmp_path / "thesis.tex").write_text("text")
    with pytest.raises(StoreError, match="not an artifact store"):
        LocalStore(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_nothing_is_created_without_create(tmp_path):
    with pytest.raises(StoreError, match="no artifact store"):
        LocalStore(tmp_path / "absent", create=False)
    assert not (tmp_path / "absent").exists()


@pytest.mark.parametrize("content", ['{"store": "moseg artifacts", "format": 3}', "{}", "[]", "", "\0"])
def test_an_unknown_format_is_refused(tmp_path, content):
    (tmp_path / "moseg-store.json").write_text(content)
    with pytest.raises(StoreError, match=r"moseg-store\.json"):
        LocalStore(tmp_path)


def test_a_store_of_the_first_format_is_read_and_renewed_by_the_first_put(tmp_path, put_toy, monkeypatch):
    with monkeypatch.context() as earlier:
        earlier.setattr(copying, "is_packable", lambda files: False)
        ref = put_toy(LocalStore(tmp_path))
    marker = tmp_path / "moseg-store.json"
    marker.write_text('{"store": "moseg artifacts", "format": 1}')
    store = LocalStore(tmp_path)
    assert np.array_equal(store.read(ref, "x"), np.arange(6.0).reshape(2, 3))
    assert put_toy(store) == ref and '"format": 1' in marker.read_text()
    packed = put_toy(store, 1)
    assert '"format": 2' in marker.read_text() and LocalStore(tmp_path).has(packed)
    assert [result.is_intact for result in store.verify()] == [True, True]


def test_a_file_cannot_be_a_store(tmp_path):
    (tmp_path / "file").write_text("text")
    with pytest.raises(StoreError, match=r"Not a directory|File exists"):
        LocalStore(tmp_path / "file")


def test_a_relative_root_stays_valid_after_a_change_of_folder(tmp_path, monkeypatch, put_toy):
    monkeypatch.chdir(tmp_path)
    store = LocalStore("store")
    ref = put_toy(store)
    monkeypatch.chdir("/")
    assert store.has(ref)


@pytest.mark.parametrize("form", ["{}", "file://{}", "file://localhost{}"])
def test_paths_and_file_urls_open_the_same_store(tmp_path, form, put_toy):
    ref = put_toy(LocalStore(tmp_path / "my store"))
    path = str(tmp_path / "my store")
    url = form.format(path if form == "{}" else path.replace(" ", "%20"))
    assert open_store(url, create=False).has(ref)


def test_a_file_url_can_name_paths_of_any_encoding(tmp_path, put_toy):
    folder = os.fsencode(tmp_path / "latin-") + b"\xfc"
    ref = put_toy(LocalStore(os.fsdecode(folder)))
    assert open_store(f"file://{quote(folder)}", create=False).has(ref)


@pytest.mark.parametrize(
    "url", ["http://server/store", "ftp://server/store", "file://elsewhere/store", "file://", "", "memory://"]
)
def test_other_urls_are_bad_input_and_the_error_lists_supported_ones(url):
    with pytest.raises(InputError, match="file:///path"):
        open_store(url)


def test_a_full_disk_gives_one_line_and_leaves_no_files(store, monkeypatch):
    def no_space(path, content):
        raise OSError(28, "No space left on device", path)

    monkeypatch.setattr(moves, "_write", no_space)
    with pytest.raises(StoreError, match="No space left on device") as caught:
        store.put(Recipe(task="toy", version=1), {}, dims={})
    assert "\n" not in str(caught.value) and str(store.root) in str(caught.value)
    assert not store.has(Recipe(task="toy", version=1).ref)
    assert list((store.root / "staging").iterdir()) == []


@contextmanager
def without_root_rights() -> Iterator[None]:
    """Run the block as user nobody if this process is root, who may write anywhere."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.mark.skipif(not hasattr(os, "seteuid"), reason="needs POSIX users")
def test_a_read_only_store_can_be_read_and_refuses_writes(put_toy):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        ref = put_toy(LocalStore(root))
        folders = [root, *(path for path in root.rglob("*") if path.is_dir())]
        for path in folders:
            path.chmod(0o555)
        try:
            with without_root_rights():
                store = LocalStore(root)
                assert np.array_equal(store.read(ref, "x"), np.arange(6.0).reshape(2, 3))
                assert [result.is_intact for result in store.verify()] == [True]
                assert (
                    store.put(Recipe(task="toy", version=1, params={"number": 0}), {}, dims={}) is PutOutcome.LOST_RACE
                )
                for write in (
                    lambda: put_toy(store, 1),
                    lambda: store.remove(ref),
                    lambda: store.quarantine(ref, "reason"),
                    lambda: store.pin("run", [ref]),
                    lambda: store.gc(is_dry=False, grace_seconds=0),
                    lambda: LocalStore(root / "new"),
                ):
                    with pytest.raises(StoreError, match="Permission denied") as caught:
                        write()
                    assert "\n" not in str(caught.value)
                assert store.gc(grace_seconds=0).removed == (ref,)
        finally:
            for path in folders:
                path.chmod(0o755)
