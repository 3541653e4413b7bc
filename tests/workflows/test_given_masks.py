"""Given masks keep their own ids, 255 beside ids is void, and a frame without a mask has no object."""

import json
import shutil

import cv2
import numpy as np
import pytest
from PIL import Image

from moseg.store import open_store

SECTIONS = ("--section-length", "4", "--set", "sections.overlap=2")
VOID = np.s_[60:90, 4:40]
NUM_FRAMES = 10


@pytest.fixture
def given(squares, write_image, tmp_path):
    """Return a function that writes masks of some frames, with ids 3 and 9 and a patch of 255, and their labels."""

    def write(folder=tmp_path / "given", numbers=range(NUM_FRAMES), ids=(0, 3, 9)):
        labels = np.zeros((NUM_FRAMES, 96, 128), np.uint8)
        for number in numbers:
            mask = cv2.imread(str(squares / "squares" / "masks" / f"{number:05d}.png"), cv2.IMREAD_UNCHANGED)
            labels[number] = np.array(ids, np.uint8)[mask]
            written = labels[number].copy()
            written[VOID] = 255
            write_image(folder / f"{number:05d}.png", written)
        labels[:, *VOID] = 0
        return folder, labels

    return write


@pytest.fixture
def segment(squares, moseg, tmp_path):
    """Return a function that segments the squares with masks of a folder and returns masks and `motion.json`."""

    def call(folder, *more):
        options = ("--proposals", f"folder:{folder}", "--store", tmp_path / "store", "--out", tmp_path / "out")
        ran = moseg("segment", squares / "squares" / "frames", *options, "--quiet", *SECTIONS, *more)
        assert (ran.code, ran.err) == (0, "")
        masks = [np.asarray(Image.open(path)) for path in sorted((tmp_path / "out" / "masks").iterdir())]
        return np.stack(masks), json.loads((tmp_path / "out" / "motion.json").read_text())

    return call


def _identities(store):
    """Return the ids of the given objects of every section."""
    store = open_store(str(store), create=False)
    return [store.attributes(ref)["identities"] for ref in store.refs("proposals")]


@pytest.mark.parametrize("variant", ["base", "fused"])
def test_masks_and_summary_keep_the_ids_of_the_given_objects(given, segment, variant):
    folder, labels = given()
    masks, motion = segment(folder, "--variant", variant)
    np.testing.assert_array_equal(masks, labels)
    assert [entry["identity"] for entry in motion["objects"]] == [3, 9]
    assert [entry["num_frames"] for entry in motion["objects"]] == [NUM_FRAMES, NUM_FRAMES]


def test_the_id_of_a_static_object_is_not_reused(given, segment):
    folder, labels = given()
    masks, motion = segment(folder, "--motions", "1")
    assert not masks.any()
    assert motion["objects"] == []
    assert labels.any()


def test_ids_survive_the_reduction_of_large_frames(given, segment):
    folder, _ = given()
    masks, motion = segment(folder, "--variant", "base", "--set", "max_side=64")
    assert masks.shape == (NUM_FRAMES, 96, 128)
    assert np.unique(masks).tolist() == [0, 3, 9]
    assert [entry["identity"] for entry in motion["objects"]] == [3, 9]


def test_a_frame_without_a_mask_shows_no_object(given, segment):
    # The second of the three sections has a single mask, the third none.
    folder, labels = given(numbers=(0, 1, 2, 3, 5))
    masks, motion = segment(folder, "--variant", "base")
    np.testing.assert_array_equal(masks, labels)
    for entry in motion["objects"]:
        assert (entry["first_frame"], entry["last_frame"], entry["num_frames"]) == (0, 5, 5)


def test_an_object_that_appears_late_keeps_its_id(given, segment):
    folder, labels = given(numbers=range(6), ids=(0, 0, 9))
    _, later = given(numbers=range(6, NUM_FRAMES))
    masks, motion = segment(folder, "--variant", "base")
    np.testing.assert_array_equal(masks, np.concatenate([labels[:6], later[6:]]))
    assert [(entry["identity"], entry["first_frame"]) for entry in motion["objects"]] == [(3, 6), (9, 0)]


@pytest.mark.parametrize("variant", ["base", "fused"])
def test_masks_without_an_object_are_all_static(segment, write_image, tmp_path, variant):
    for number in range(NUM_FRAMES):
        write_image(tmp_path / "given" / f"{number:05d}.png", np.zeros((96, 128), np.uint8))
    masks, motion = segment(tmp_path / "given", "--variant", variant)
    assert masks.shape == (NUM_FRAMES, 96, 128)
    assert not masks.any()
    assert motion["objects"] == []


def _folder_tree(root, frames, given):
    shutil.copytree(frames, root / "dog" / "frames")
    given(root / "dog" / "masks")


def _davis_tree(root, frames, given):
    shutil.copytree(frames, root / "JPEGImages" / "480p" / "dog")
    given(root / "Annotations" / "480p" / "dog")


@pytest.mark.parametrize(("dataset", "write_tree"), [("folder", _folder_tree), ("davis-moving", _davis_tree)])
@pytest.mark.parametrize("is_own", [False, True])
def test_void_is_no_object_of_an_evaluation(squares, given, moseg, tmp_path, dataset, write_tree, is_own):
    write_tree(tmp_path / "data", squares / "squares" / "frames", given)
    proposals = f"folder:{given()[0]}" if is_own else "groundtruth"
    options = ("--dataset", dataset, "--root", tmp_path / "data", "--sequences", "dog", "--proposals", proposals)
    files = ("--store", tmp_path / "store", "--json", tmp_path / "report.json")
    ran = moseg("eval", *options, *files, *SECTIONS, "--variant", "base", "--variant", "fused", "--motions", "gt")
    assert ran.code == 0
    assert {*map(tuple, _identities(tmp_path / "store"))} == {(3, 9)}
    report = json.loads((tmp_path / "report.json").read_text())
    for row in report["rows"]:
        assert row["mean"]["F"] == pytest.approx(100)
    store = open_store(str(tmp_path / "store"), create=False)
    (clustering,) = store.refs("clustering")
    # The background and two objects.
    assert store.manifest(clustering).recipe.params["num_motions"] == 3
