"""Reading of files into what a network is built from."""

import pickle
import zipfile
from argparse import Namespace

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from moseg.schemas.errors import InputError

TENSORS = {"a.weight": torch.arange(6.0).reshape(2, 3), "a.bias": torch.ones(2)}


@pytest.fixture
def read(describe, open_folder, folder):
    """Return a function that reads an own item whose files the function `save` writes into its folder."""

    def read_item(save, *names, architecture="raft", config=None):
        files = [{"name": name} for name in names]
        describe({"architecture": architecture, "files": files, "config": config or {}})
        (folder / "net").mkdir(exist_ok=True)
        save(folder / "net")
        weights = open_folder(offline=True)
        item = weights.item("net")
        return weights.read(item, weights.digests(item))

    return read_item


def _assert_same(tensors):
    assert sorted(tensors) == sorted(TENSORS)
    assert all(torch.equal(tensors[name], TENSORS[name]) for name in TENSORS)


@pytest.mark.parametrize("content", [TENSORS, {"state_dict": TENSORS, "epoch": 3}, {"model": TENSORS}])
@pytest.mark.parametrize("is_zip", [True, False])
def test_saved_by_torch(read, content, is_zip):
    def save(folder):
        torch.save(content, folder / "model.pth", _use_new_zipfile_serialization=is_zip)

    checkpoint = read(save, "model.pth", config={"hidden_channels": 8})
    _assert_same(checkpoint.tensors)
    assert (checkpoint.name, checkpoint.documents, checkpoint.config) == ("net", {}, {"hidden_channels": 8})


@pytest.mark.parametrize("place", [b"numpy.core.multiarray", b"numpy._core.multiarray"])
@pytest.mark.parametrize("rate", [np.float64(1e-4), np.float32(1e-4), np.int64(3)])
def test_an_optimiser_with_numbers_of_numpy_can_be_read(read, place, rate):
    optimizer = {"state": {}, "param_groups": [{"lr": rate, "params": [0], "name": "a.weight"}]}

    def save(folder):
        torch.save({"state_dict": TENSORS, "optimizer": optimizer}, folder / "model.pth")
        _replace_in_pickle(folder / "model.pth", b"numpy._core.multiarray", place)

    _assert_same(read(save, "model.pth").tensors)


def _replace_in_pickle(path, old, new):
    """Replace a module's name in a checkpoint by its name when the published ones were saved."""
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content.replace(old, new) if name.endswith("data.pkl") else content)


class _Reduced:
    """An object that is pickled as a call and a state."""

    def __init__(self, *reduced):
        self._reduced = reduced

    def __reduce__(self):
        return self._reduced


def test_bytes_are_not_taken_for_addresses(read):
    """Check that a dtype cannot be made to hold objects: NumPy would take a number's bytes for an address."""
    scalar = np.float64().__reduce__()[0]
    holder = _Reduced(np.dtype, ("O8", False, True))
    crafted = _Reduced(np.dtype, ("f8", False, True), (3, "<", None, ("x",), {"x": (holder, 0)}, 8, 8, 0))
    void = _Reduced(np.dtype, ((_Reduced(np.dtype, ("V8",)), crafted),))

    def save(folder):
        content = {"model": TENSORS, "more": _Reduced(scalar, (void, b"A" * 8))}
        torch.save(content, folder / "model.pth", pickle_protocol=2)

    with pytest.raises(InputError, match="unreadable weights"):
        read(save, "model.pth")


@pytest.mark.parametrize("name", ["model.pth", "model.safetensors"])
def test_tensors_do_not_follow_later_changes_of_the_file(read, folder, name):
    def save(folder):
        torch.save(TENSORS, folder / name) if name.endswith("pth") else save_file(TENSORS, folder / name)

    checkpoint = read(save, name)
    with open(folder / "net" / name, "r+b") as file:
        file.write(b"\xff" * (folder / "net" / name).stat().st_size)
    _assert_same(checkpoint.tensors)


def test_tensors_outlive_their_file(read, folder):
    checkpoint = read(lambda folder: torch.save(TENSORS, folder / "model.pth"), "model.pth")
    (folder / "net" / "model.pth").unlink()
    _assert_same(checkpoint.tensors)


def test_safetensors_with_documents(read):
    def save(folder):
        save_file(TENSORS, folder / "model.safetensors")
        (folder / "config.json").write_text('{"name": "Grüße"}', encoding="utf-8")
        (folder / "merges.txt").write_text("")

    checkpoint = read(save, "config.json", "model.safetensors", "merges.txt", architecture="sam2")
    _assert_same(checkpoint.tensors)
    assert checkpoint.documents == {"config.json": '{"name": "Grüße"}', "merges.txt": ""}


class _Runs:
    def __reduce__(self):
        return (print, ("what a file must not do",))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"not tensors at all",
        pickle.dumps(_Runs()),
        pickle.dumps({"model": TENSORS, "args": Namespace(lr=0.1)}),
    ],
)
def test_a_file_that_torch_does_not_read_safely_is_refused_by_name(read, folder, content, capsys):
    with pytest.raises(InputError, match=f"unreadable weights in {folder}/net/model.pth; got .*; expected tensors"):
        read(lambda folder: (folder / "model.pth").write_bytes(content), "model.pth")
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("content", "got"),
    [
        (b"", "a damaged file or one of another format"),
        (b"<html>", "a damaged file or one of another format"),
        (b"\0" * 1000, "a damaged file or one of another format"),
        (b"not tensors at all", "a damaged file or one of another format"),
        (b"\x80\x09}q\x00.", "a damaged file or one of another format"),
        (b"PK\x03\x04 and what is no archive", "a damaged archive"),
    ],
)
def test_torch_s_advice_on_a_bad_file_is_not_shown(read, folder, content, got, capsys):
    with pytest.raises(InputError) as refused:
        read(lambda folder: (folder / "model.pth").write_bytes(content), "model.pth")
    assert str(refused.value) == (
        f"unreadable weights in {folder}/net/model.pth; got {got};"
        " expected tensors saved by torch, and no code to be run"
    )
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("more", "named"),
    [(_Runs(), "print"), (Namespace(lr=0.1), "argparse.Namespace"), (np.array([_Runs()], dtype=object), "numpy")],
)
def test_code_in_a_file_is_named(read, folder, more, named, capsys):
    def save(folder):
        torch.save({"model": TENSORS, "more": more}, folder / "model.pth")

    with pytest.raises(InputError, match=rf"unreadable weights in {folder}/net/model.pth; got \S*{named}\S*; expected"):
        read(save, "model.pth")
    assert capsys.readouterr().out == ""


def test_a_cut_archive_is_refused_by_name(read, folder):
    def save(folder):
        torch.save(TENSORS, folder / "model.pth")
        (folder / "model.pth").write_bytes((folder / "model.pth").read_bytes()[:-100])

    with pytest.raises(InputError, match=f"unreadable weights in {folder}/net/model.pth; got a damaged archive; "):
        read(save, "model.pth")


@pytest.mark.parametrize("content", [b"", b"\x10" + b"\0" * 7 + b"{not a header of}", b"x" * 100])
def test_a_file_that_is_not_safetensors_is_refused_by_name(read, folder, content):
    def save(folder):
        (folder / "model.safetensors").write_bytes(content)
        (folder / "config.json").write_text("{}")

    with pytest.raises(InputError, match=f"unreadable weights in {folder}/net/model.safetensors"):
        read(save, "config.json", "model.safetensors", architecture="sam2")


def test_a_document_that_is_not_text_is_refused_by_name(read, folder):
    def save(folder):
        torch.save(TENSORS, folder / "model.pth")
        (folder / "tags.txt").write_bytes(b"caf\xe9")
        (folder / "thresholds.txt").write_text("")

    with pytest.raises(InputError, match=f"unreadable file in {folder}/net/tags.txt; .*; expected UTF-8 text"):
        read(save, "model.pth", "tags.txt", "thresholds.txt", architecture="ram")


def test_a_file_without_a_state_dict_is_refused(read):
    with pytest.raises(InputError, match="no state dict in weights net"):
        read(lambda folder: torch.save({"epoch": 3}, folder / "model.pth"), "model.pth")


def test_digests_of_other_files_are_refused(describe, open_folder):
    describe({"files": [{"name": "model.pth"}]})
    weights = open_folder()
    with pytest.raises(InputError, match=r"other weights files in weights net; got model.pth; expected model.bin"):
        weights.read(weights.item("net"), {"model.bin": "0" * 64})


def test_a_file_written_to_while_it_is_read_is_refused(describe, open_folder, folder, monkeypatch):
    describe({"files": [{"name": "model.pth"}]})
    (folder / "net").mkdir()
    path = folder / "net" / "model.pth"
    torch.save(TENSORS, path)
    weights = open_folder()

    def write_meanwhile(item, home):
        path.write_bytes(b"")

    monkeypatch.setattr("moseg.workflows.weights.item_folder.read_checkpoint", write_meanwhile)
    with pytest.raises(InputError, match=f"written to while it was read in {path}"):
        weights.read(weights.item("net"), weights.digests(weights.item("net")))
