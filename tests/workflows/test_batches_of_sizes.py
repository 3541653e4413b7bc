"""Frames of several sequences in one batch of a network may have several sizes."""

import cv2
import pytest

from moseg.store import open_store


@pytest.fixture
def root(write_squares, tmp_path):
    """A data set with a sequence of 128x96 px and one of 144x96 px."""
    for name in ("small", "wide"):
        write_squares(tmp_path / "data" / name, num_frames=3)
    for path in (tmp_path / "data" / "wide").rglob("*.png"):
        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        cv2.imwrite(str(path), cv2.copyMakeBorder(image, 0, 0, 0, 16, cv2.BORDER_REPLICATE))
    return tmp_path / "data"


@pytest.mark.parametrize("backend", ["--flow raft", "--depth depth-anything-v2", "--depth dpt-dinov2"])
def test_sequences_of_several_sizes_share_batches(root, tiny, moseg, tmp_path, monkeypatch, backend):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tiny))
    option, name = backend.split()
    data = ("--dataset", "folder", "--root", root, "--proposals", "groundtruth", "--store", tmp_path / "store")
    ran = moseg("eval", *data, option, name, "--batch", "8", "--device", "cpu", "--quiet")
    assert ran.code == 0, ran.err
    store, stage = open_store(str(tmp_path / "store"), create=False), option.removeprefix("--")
    array = {"flow": "flow", "depth": "inverse_depth"}[stage]
    shapes = {store.read(ref, array).shape[:2] for ref in store.refs(stage)}
    assert shapes == {(96, 128), (96, 144)}
