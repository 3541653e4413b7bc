"""Leaves have the key of their decoded content, and ingest artifacts that of the files' bytes."""

import os
import shutil

import cv2
import numpy as np
import pytest

from moseg.store import open_store
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.engine.ingest import IngestJob, preview_ingest, run_ingest
from moseg.workflows.engine.session import Session
from moseg.workflows.sources import open_frames, open_masks


@pytest.fixture
def folder(write_squares, tmp_path):
    return write_squares(tmp_path / "squares", num_frames=5)


@pytest.fixture
def ingest(tmp_path):
    """Return a function that ingests sources of one kind and returns their attributes and the number decoded."""

    def call(kind, *sources):
        session = Session(open_store(str(tmp_path / "store")), SynchronousRunner(), quiet=True)
        found = session.ingest([IngestJob(kind, source) for source in sources])
        return found, session.computed.total()

    return call


def _frames(folder, max_side=1280):
    return open_frames(str(folder), max_side)


def _store(tmp_path):
    return open_store(str(tmp_path / "store"))


def test_leaves_hold_the_decoded_pixels(folder, ingest, tmp_path):
    ((found,), _) = ingest("frame", _frames(folder / "frames"))
    first = cv2.imread(str(folder / "frames" / "00000.png"))[..., ::-1]
    assert found["shape"] == [96, 128]
    assert len(found["leaves"]) == 5
    np.testing.assert_array_equal(_store(tmp_path).read(found["leaves"][0], "image"), first)


def test_equal_frames_under_another_name_and_path_are_the_same_leaves(folder, ingest, tmp_path):
    other = tmp_path / "elsewhere"
    other.mkdir()
    for path in (folder / "frames").iterdir():
        shutil.copy(path, other / f"image-{path.name}")
    (first,), _ = ingest("frame", _frames(folder / "frames"))
    (second,), num_decoded = ingest("frame", _frames(other))
    assert second == first
    assert num_decoded == 0


def test_equal_pixels_in_other_files_are_the_same_leaves(folder, ingest, write_image, tmp_path):
    for path in (folder / "frames").iterdir():
        write_image(tmp_path / "bmp" / f"{path.stem}.bmp", cv2.imread(str(path)))
    (first,), _ = ingest("frame", _frames(folder / "frames"))
    (second,), num_decoded = ingest("frame", _frames(tmp_path / "bmp"))
    assert second == first
    assert num_decoded == 1


def test_another_modification_time_is_not_another_file(folder, ingest):
    ingest("frame", _frames(folder / "frames"))
    for path in (folder / "frames").iterdir():
        os.utime(path, (0, 0))
    assert ingest("frame", _frames(folder / "frames"))[1] == 0


def test_one_changed_pixel_is_one_other_leaf(folder, ingest, write_image):
    (before,), _ = ingest("frame", _frames(folder / "frames"))
    path = folder / "frames" / "00002.png"
    image = cv2.imread(str(path))
    image[-1, -1, -1] ^= 1
    write_image(path, image)
    os.utime(path, (0, 0))
    (after,), _ = ingest("frame", _frames(folder / "frames"))
    changed = [old != new for old, new in zip(before["leaves"], after["leaves"], strict=True)]
    assert changed == [False, False, True, False, False]


def test_another_size_of_analysis_is_another_leaf(folder, ingest):
    (full,), _ = ingest("frame", _frames(folder / "frames"))
    (small,), _ = ingest("frame", _frames(folder / "frames", max_side=64))
    assert small["shape"] == [48, 64]
    assert not set(small["leaves"]) & set(full["leaves"])


def test_leaves_do_not_depend_on_how_frames_are_split_into_calls(folder, ingest):
    source = _frames(folder / "frames")
    whole, _ = ingest("frame", source)
    parts, _ = ingest("frame", *source.chunks(2))
    assert [leaf for part in parts for leaf in part["leaves"]] == whole[0]["leaves"]


def test_a_missing_leaf_is_ingested_again(folder, ingest, tmp_path):
    source = _frames(folder / "frames")
    (before,), _ = ingest("frame", source)
    store = _store(tmp_path)
    kept = store.manifest(before["leaves"][0])
    store.remove(before["leaves"][3])
    (after,), num_decoded = ingest("frame", source)
    assert after == before
    assert num_decoded == 1
    assert store.has(before["leaves"][3])
    assert store.manifest(before["leaves"][0]) == kept


def test_the_memory_of_other_leaves_is_replaced(folder, ingest, tmp_path):
    source = _frames(folder / "frames")
    (before,), _ = ingest("frame", source)
    store, recipe = _store(tmp_path), IngestJob("frame", source).recipe
    store.remove(recipe.ref)
    # Of a leaf that is in no store.
    store.put(recipe, {}, {**before, "leaves": [f"frame/{'0' * 64}"]})
    (after,), num_decoded = ingest("frame", source)
    assert after == store.attributes(recipe.ref) == before
    assert num_decoded == 1


def test_a_preview_names_the_leaves_and_stores_nothing(folder, ingest, tmp_path):
    frames = _frames(folder / "frames")
    masks = open_masks(str(folder / "masks"), frames)
    previews = [preview_ingest(IngestJob("frame", frames)), preview_ingest(IngestJob("annotation", masks))]
    assert not (tmp_path / "store").exists()
    (found_frames,), _ = ingest("frame", frames)
    (found_masks,), _ = ingest("annotation", masks)
    assert previews == [found_frames, found_masks]


def test_masks_keep_the_frames_they_belong_to(folder, ingest, tmp_path):
    frames = _frames(folder / "frames")
    for name in ("00000.png", "00003.png"):
        (folder / "masks" / name).unlink()
    (found,), _ = ingest("annotation", open_masks(str(folder / "masks"), frames))
    (ref,) = found["leaves"]
    assert found["labels"] == [1, 2]
    assert _store(tmp_path).attributes(ref)["indices"] == [1, 2, 4]
    assert _store(tmp_path).manifest(ref).array("masks").shape == (3, 96, 128)


def test_masks_of_other_frames_are_another_leaf(folder, ingest):
    frames = _frames(folder / "frames")
    (before,), _ = ingest("annotation", open_masks(str(folder / "masks"), frames))
    (folder / "masks" / "00004.png").unlink()
    (after,), _ = ingest("annotation", open_masks(str(folder / "masks"), frames))
    assert after["leaves"] != before["leaves"]


class Masks:
    """Equal masks of the given frames."""

    def __init__(self, *indices):
        self._indices = indices

    def read(self):
        return ((index, np.ones((4, 5), np.uint16)) for index in self._indices)

    def fingerprint(self):
        return repr(self._indices)


def test_equal_masks_of_other_frames_are_another_leaf(tmp_path):
    store = open_store(str(tmp_path / "store"))
    jobs = [IngestJob("annotation", Masks(*indices)) for indices in ((0, 1), (0, 5))]
    found = run_ingest(store, [(job, job.recipe) for job in jobs])
    (first,), (second,) = (memory["leaves"] for memory in found.values())
    assert [store.attributes(ref)["indices"] for ref in (first, second)] == [[0, 1], [0, 5]]
