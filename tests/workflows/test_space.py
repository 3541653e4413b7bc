"""Disk space: what work will take is estimated, and too little is one line before anything is computed."""

import os
import shutil

import cv2
import numpy as np
import pytest

from moseg.schemas.recipes import Recipe, leaf_recipe
from moseg.store import LocalStore, open_store
from moseg.workflows.engine import session
from moseg.workflows.engine.space import BYTES_PER_PIXEL, check_space, plan_nbytes, video_nbytes
from moseg.workflows.sources.likely_length import likely_num_frames
from moseg.workflows.sources.video_file import VideoFile


@pytest.fixture
def free(monkeypatch):
    """Return a function that sets the free bytes of every local store."""
    return lambda nbytes: monkeypatch.setattr(LocalStore, "free_nbytes", lambda self: nbytes)


@pytest.fixture
def segment(squares, tmp_path, moseg):
    arguments = ("segment", squares / "squares" / "frames", "--store", tmp_path / "store", "--out", tmp_path / "out")
    return lambda *more: moseg(*arguments, *more)


def _has_one_line(ran):
    return ran.code == 2 and ran.err.count("\n") == 1 and "too little space on the disk" in ran.err


def test_a_full_disk_is_one_line_before_anything_is_computed(segment, tmp_path, free):
    free(1000)
    ran = segment()
    assert _has_one_line(ran) and "1000 B free" in ran.err and "about 7.3 MiB" in ran.err
    assert list(open_store(str(tmp_path / "store")).refs()) == []
    assert not list((tmp_path / "out").rglob("*.*"))


def test_work_that_goes_on_is_checked_for_what_is_missing(segment, tmp_path, free):
    assert segment("--quiet").code == 0
    free(1000)
    assert segment("--quiet").code == 0
    before = set(open_store(str(tmp_path / "store")).refs())
    assert _has_one_line(segment("--set", "flow.preset=fast"))
    assert set(open_store(str(tmp_path / "store")).refs()) == before


def test_evaluations_are_checked_too(squares, tmp_path, moseg, free):
    free(1000)
    ran = moseg("eval", "--dataset", "folder", "--root", squares, "--store", tmp_path / "store")
    assert _has_one_line(ran)


def test_much_work_is_reported_and_a_store_without_a_limit_is_not_checked(free, tmp_path):
    store = LocalStore(tmp_path)
    lines = []
    free(10**12)
    check_space(store, 10**9, lines.append)
    check_space(store, 2 * 2**30, lines.append)
    assert lines == ["about 2.0 GiB of disk while it runs (931.3 GiB free)"]
    free(None)
    check_space(store, 10**15, lines.append)
    assert len(lines) == 1


def test_the_estimate_is_near_what_a_run_takes(segment, tmp_path):
    assert segment("--keep-cues", "--quiet").code == 0
    store = open_store(str(tmp_path / "store"))
    stored = sum(use.nbytes for task, use in store.usage().items() if task != "motion_weights")
    assert 0.5 < stored / video_nbytes(10, (96, 128)) < 2


def test_frames_of_a_video_are_counted_without_decoding(tmp_path, video_file):
    path = video_file(tmp_path / "clip.mp4", 7)
    assert likely_num_frames(VideoFile(str(path), 64)) == VideoFile(str(path), 64).num_frames() == 7
    assert likely_num_frames(VideoFile(str(path), 64).choose((1, 4))) == 2


def test_only_sequences_that_have_to_be_decoded_are_counted(squares, tmp_path, moseg, monkeypatch):
    counted = []
    monkeypatch.setattr(session, "check_space", lambda store, nbytes, report: counted.append(nbytes))
    for number, name in enumerate(("one", "two", "three")):
        shutil.copytree(squares / "squares", tmp_path / "data" / name)
        for path in (tmp_path / "data" / name / "frames").iterdir():
            image = cv2.imread(str(path))
            # Other bytes, which have to be decoded.
            image[0, 0] = number
            cv2.imwrite(str(path), image)
        places = ("--root", tmp_path / "data", "--store", tmp_path / "store")
        assert moseg("eval", "--dataset", "folder", *places, "--quiet").code == 0
    ingests = [nbytes for nbytes in counted if nbytes == video_nbytes(10, (96, 128))]
    assert len(ingests) == 3


def test_a_store_of_a_given_size_loses_what_was_not_used_for_longest(segment, tmp_path, moseg, monkeypatch):
    assert segment("--quiet").code == 0
    store = open_store(str(tmp_path / "store"))
    old = Recipe(task="toy", version=1)
    store.put(old, {"x": np.zeros(1000)}, dims={"x": ("a",)})
    key = old.key
    os.utime(store.root / "objects" / "toy" / key[:2] / key, (10**9, 10**9))
    before = set(store.refs())
    monkeypatch.setenv("MOSEG_STORE_SIZE", "10K")
    assert segment("--quiet").code == 0
    assert set(store.refs()) == before
    ran = segment("--set", "affinity.scale=0.7")
    assert ran.code == 0 and "MOSEG_STORE_SIZE: 1 least recently used artifacts removed" in ran.err
    assert before - set(store.refs()) == {old.ref}
    monkeypatch.setenv("MOSEG_STORE_SIZE", "small")
    ran = segment()
    assert ran.code == 2 and "MOSEG_STORE_SIZE" in ran.err


@pytest.fixture
def video_file():
    import av

    def write(path, count):
        with av.open(str(path), "w") as container:
            stream = container.add_stream("mpeg4", rate=10)
            stream.width, stream.height = 64, 48
            for number in range(count):
                image = np.full((48, 64, 3), 30 * number, np.uint8)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
            container.mux(stream.encode())
        return path

    return write


ON_GRID = 20 * 40
"""Pixels of the working grid of frames of 10 x 20 px, which are enlarged to it."""


def test_the_space_of_a_plan_grows_with_the_frames_of_its_artifacts(tmp_path):
    store, frame = LocalStore(tmp_path), leaf_recipe("frame", "0" * 64)
    store.put(frame, {"image": np.zeros((10, 20, 3), np.uint8)}, dims={"image": ("y", "x", "rgb")})
    first = Recipe(task="saliency", version=1, inputs={"frame": frame.ref})
    many = Recipe(task="consistency", version=1, inputs={"saliency": (first.ref,) * 3})
    expected = ON_GRID * (BYTES_PER_PIXEL["saliency"] + 3 * BYTES_PER_PIXEL["consistency"])
    assert plan_nbytes(store, {each.ref: each for each in (first, many)}) == pytest.approx(expected)


def test_the_size_of_frames_is_known_where_all_are_filled(tmp_path):
    store, filled = LocalStore(tmp_path), Recipe(task="filled_frame", version=1, inputs={"frame": "frame/" + "0" * 64})
    store.put(filled, {"image": np.zeros((10, 20, 3), np.uint8)}, dims={"image": ("y", "x", "rgb")})
    saliency = Recipe(task="saliency", version=1, inputs={"frame": filled.ref})
    assert plan_nbytes(store, {saliency.ref: saliency}) == pytest.approx(ON_GRID * BYTES_PER_PIXEL["saliency"])
