"""Saved masks are scored against the frames of their names, and other matching is reported."""

import json

import numpy as np
import pytest
from PIL import Image

FIRST, NUM_FRAMES, SHAPE = 5, 20, (24, 64)
STEMS = tuple(f"{number:05d}" for number in range(FIRST, FIRST + NUM_FRAMES))
BY_NUMBER = "note: masks taken for the frames by their number, counted from 0, not by name: dog"
IN_ORDER = "note: masks taken for the frames in order, not by name: dog"
REPEATED = "note: no mask of the last frame, which is scored with that of the frame before: dog"


def _mask(index):
    """Return a mask with a square at a position of this frame only."""
    mask = np.zeros(SHAPE, np.uint8)
    mask[4:10, 3 * index : 3 * index + 3] = 1
    return mask


def _save_png(path, mask):
    Image.fromarray(mask).save(path)


def _save_pfm(path, mask):
    path.write_bytes(b"Pf\n%d %d\n-1\n" % SHAPE[::-1] + mask[::-1].astype("<f4").tobytes())


def _save_layers(path, mask):
    np.save(path, np.stack([mask == 0, mask == 1]).astype(np.float32))


FORMATS = {
    "png": ("{}.png", _save_png),
    "rigidmask": ("pm-{}.pfm", _save_pfm),
    "em": ("{}_proba.npy", _save_layers),
    "em-binary": ("{}_binary.png", _save_png),
}


@pytest.fixture
def dataset(tmp_path):
    """Return a function that writes a sequence `dog` with ground truth of some frames, and returns its root."""

    def write(annotated, stems=STEMS):
        root = tmp_path / "data"
        for folder in ("frames", "masks"):
            (root / "dog" / folder).mkdir(parents=True)
        for index, stem in enumerate(stems):
            Image.new("RGB", SHAPE[::-1], (index, 0, 0)).save(root / "dog" / "frames" / f"{stem}.png")
            if stem in annotated:
                Image.fromarray(_mask(index)).save(root / "dog" / "masks" / f"{stem}.png")
        return root

    return write


@pytest.fixture
def predictions(tmp_path):
    """Return a function that writes perfect masks by name and index of the frame, and returns their folder."""

    def write(index_of, format="png"):
        names, save = FORMATS[format]
        (tmp_path / "saved" / "dog").mkdir(parents=True)
        for name, index in index_of.items():
            save(tmp_path / "saved" / "dog" / names.format(name), _mask(index))
        return tmp_path / "saved"

    return write


@pytest.fixture
def score(moseg, tmp_path):
    """Return a function that scores predictions and returns J, the matching in the report, and the output."""

    def call(root, saved):
        data = ("--dataset", "folder", "--root", root, "--predictions", saved)
        ran = moseg("score", *data, "--json", tmp_path / "report.json", "--quiet")
        assert (ran.code, ran.err) == (0, "")
        report = json.loads((tmp_path / "report.json").read_text())
        return report["rows"][0]["sequences"]["dog"]["J"], report["matching"]["dog"], ran.out

    return call


@pytest.fixture
def refused(moseg):
    """Return a function that scores unusable predictions and returns the error's line."""

    def call(root, saved):
        ran = moseg("score", "--dataset", "folder", "--root", root, "--predictions", saved, "--quiet")
        assert (ran.code, ran.out) == (2, "")
        assert len(ran.err.splitlines()) == 1, ran.err
        return ran.err

    return call


def _own(*stems):
    return {stem: STEMS.index(stem) for stem in stems}


@pytest.mark.parametrize("format", FORMATS)
def test_masks_of_some_frames_are_scored_against_the_frames_of_their_names(dataset, predictions, score, format):
    saved = predictions(_own("00010", "00015", "00020"), format)
    found, way, out = score(dataset({"00015"}), saved)
    assert (found, way) == (100, "name")
    assert "note" not in out


def test_masks_of_all_frames_are_matched_by_name(dataset, predictions, score):
    found, way, out = score(dataset(STEMS), predictions(_own(*STEMS)))
    assert (found, way) == (100, "name")
    assert "note" not in out


@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("width", [1, 5])
def test_one_mask_for_each_frame_may_be_numbered_from_0_or_1(dataset, predictions, score, start, width):
    saved = predictions({f"{start + index:0{width}d}": index for index in range(NUM_FRAMES)})
    found, way, out = score(dataset(STEMS), saved)
    assert (found, way) == (100, "order")
    assert IN_ORDER in out


def test_one_mask_for_each_frame_may_have_other_names(dataset, predictions, score):
    saved = predictions({f"result_{10 * index}": index for index in range(NUM_FRAMES)})
    found, way, out = score(dataset(STEMS), saved)
    assert (found, way) == (100, "order")
    assert IN_ORDER in out


def test_a_few_masks_without_names_of_frames_are_numbered_from_0(dataset, predictions, score):
    stems = tuple(f"im{number}" for number in range(NUM_FRAMES))
    saved = predictions({"mask_2": 2, "mask_10": 10})
    found, way, out = score(dataset({"im2", "im10"}, stems), saved)
    assert (found, way) == (100, "number")
    assert BY_NUMBER in out


def test_masks_of_which_only_some_have_frame_names_are_refused_with_both(dataset, predictions, refused):
    line = refused(dataset({"00015"}), predictions({**_own("00010", "00015"), "00002": 2}))
    assert "only some have the name of a frame" in line
    assert "00010, which is a frame, and 00002, which is none" in line
    assert "saved/dog" in line


def test_as_many_masks_as_frames_of_which_one_is_another_clip_s_are_refused(dataset, predictions, refused):
    saved = predictions({**_own(*STEMS[:-1]), "overview": 0})
    assert "00005, which is a frame, and overview, which is none" in refused(dataset(STEMS), saved)


def test_a_number_that_may_mean_two_frames_is_refused_with_both(dataset, predictions, refused):
    line = refused(dataset({"00015"}), predictions({"mask_10": 10, "mask_15": 15}))
    assert "mask_10, which may be 00010 or, counted from 0, 00015" in line


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ({"a": 0, "b": 1}, "file without a frame"),
        ({"im_20": 0, "im_0": 1}, "file without a frame"),
        ({"a_0": 0, "b_0": 1}, "two files of frame 0"),
    ],
)
def test_names_without_a_frame_are_refused(dataset, predictions, refused, names, words):
    stems = tuple(f"frame{letter}" for letter in "abcdefghijklmnopqrst")
    assert words in refused(dataset({"framea"}, stems), predictions(names))


def test_a_missing_mask_of_an_annotated_frame_is_refused_by_the_frame_s_name(dataset, predictions, refused):
    line = refused(dataset({"00015", "00016"}), predictions(_own("00010", "00015")))
    assert "no prediction of frame 00016" in line
    assert "expected one for every frame with ground truth" in line


@pytest.mark.parametrize("format", ["rigidmask", "em", "em-binary"])
@pytest.mark.parametrize("start", [0, FIRST])
def test_a_method_of_pairs_repeats_its_last_mask_and_reports_it(dataset, predictions, score, format, start):
    saved = predictions({f"{start + index:05d}": index for index in range(NUM_FRAMES - 1)}, format)
    found, way, out = score(dataset(STEMS), saved)
    assert found == 95
    assert way == ("order" if start == 0 else "name")
    assert REPEATED in out
    assert (IN_ORDER in out) == (start == 0)


def test_a_method_of_pairs_without_a_mask_in_the_middle_is_refused_by_the_frame(dataset, predictions, refused):
    saved = predictions(_own(*STEMS[:9], *STEMS[10:]), "rigidmask")
    assert "no prediction of frame 00014" in refused(dataset(STEMS), saved)


def test_volumes_are_the_frames_in_order(dataset, score, tmp_path):
    (tmp_path / "saved").mkdir()
    np.savez(tmp_path / "saved" / "dog.npz", segmentation=np.stack([_mask(index) for index in range(NUM_FRAMES)]))
    found, way, out = score(dataset(STEMS), tmp_path / "saved")
    assert (found, way) == (100, "order")
    assert IN_ORDER in out


def test_rendered_frames_have_numbers_from_0(moseg, tmp_path):
    from moseg.tasks.synthetic import SCENES
    from moseg.workflows.sources import SceneMasks

    name = next(iter(SCENES))
    (tmp_path / "saved" / name).mkdir(parents=True)
    for index, mask in SceneMasks(name, "moving").read():
        Image.fromarray(mask).save(tmp_path / "saved" / name / f"{index:05d}.png")
    data = ("--sequences", name, "--predictions", tmp_path / "saved", "--json", tmp_path / "report.json")
    ran = moseg("score", *data, "--quiet")
    assert (ran.code, ran.err) == (0, "")
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["rows"][0]["mean"]["F"] == 100
    assert report["matching"] == {name: "order"}


def test_soft_masks_are_noted(dataset, predictions, score):
    root, saved = dataset({"00010", "00011"}), predictions(_own("00010", "00011"))
    assert "note" not in score(root, saved)[2]
    soft = np.tile(np.linspace(0, 252, SHAPE[1]).astype(np.uint8), (SHAPE[0], 1))
    soft[0] += 1
    Image.fromarray(soft).save(saved / "dog" / "00011.png")
    note = "more than 64 labels in a frame, each scored as an object; a soft mask must be thresholded first: dog"
    assert note in score(root, saved)[2]
