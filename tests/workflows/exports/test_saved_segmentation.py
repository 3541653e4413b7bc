"""A saved segmentation is opened whole, or its fault is named."""

import json

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.exports import summarise_sequence, write_masks, write_motion
from moseg.workflows.exports.saved_segmentation import open_segmentation

LABELS = np.zeros((3, 6, 8), np.uint16)
LABELS[:, 2:4, 2:5] = 4


@pytest.fixture
def folder(tmp_path):
    write_masks(tmp_path / "out" / "masks", LABELS)
    frames = ("x.jpg", "y.jpg", "z.jpg")
    write_motion(tmp_path / "out" / "motion.json", summarise_sequence("dog", LABELS, 24.0, 2, {4: 1}, frames=frames))
    return tmp_path / "out"


def change(folder, **values):
    content = json.loads((folder / "motion.json").read_text())
    (folder / "motion.json").write_text(json.dumps(content | values))


def test_labels_and_names_come_back(folder):
    saved = open_segmentation(folder)
    np.testing.assert_array_equal(np.stack(list(saved.labels())), LABELS)
    assert (saved.summary.name, saved.names, saved.stems) == ("dog", ("x.jpg", "y.jpg", "z.jpg"), ("x", "y", "z"))


def test_a_summary_without_names_of_frames_is_that_of_a_video(folder):
    content = json.loads((folder / "motion.json").read_text())
    del content["frames"]
    (folder / "motion.json").write_text(json.dumps(content))
    assert open_segmentation(folder).names == ("00000.png", "00001.png", "00002.png")


def test_names_of_a_folder_of_images_count_in_place_of_those_saved(folder, tmp_path):
    for name in ("f 10.png", "f 2.png", "f 1.png"):
        (tmp_path / "images").mkdir(exist_ok=True)
        Image.new("L", (8, 6)).save(tmp_path / "images" / name)
    assert open_segmentation(folder, tmp_path / "images").names == ("f 1.png", "f 2.png", "f 10.png")
    assert open_segmentation(folder, name="other").summary.name == "other"
    Image.new("L", (6, 8)).save(tmp_path / "images" / "f 2.png")
    with pytest.raises(InputError, match=r"image of the wrong size in .*f 2\.png; got 6x8 px; expected 8x6 px"):
        open_segmentation(folder, tmp_path / "images")
    (tmp_path / "images" / "f 2.png").unlink()
    with pytest.raises(InputError, match=r"differ in number in .*images; got 2 names of frames; expected 3"):
        open_segmentation(folder, tmp_path / "images")


def test_images_that_exif_turns_are_named(folder, tmp_path):
    (tmp_path / "images").mkdir()
    exif = Image.Exif()
    exif[0x0112] = 6
    for number in range(3):
        Image.new("L", (6, 8)).save(tmp_path / "images" / f"{number}.jpg", exif=exif)
    expected = r"0\.jpg; got 6x8 px and an EXIF orientation that turns them; expected 8x6 px, as in .*, turned without"
    with pytest.raises(InputError, match=expected):
        open_segmentation(folder, tmp_path / "images")


def test_a_folder_that_holds_no_segmentation_is_named(tmp_path):
    with pytest.raises(MissingInputError, match=r"no segmentation in .*; expected motion.json and masks/"):
        open_segmentation(tmp_path)


def test_a_missing_mask_is_named(folder):
    (folder / "masks" / "00001.png").unlink()
    with pytest.raises(MissingInputError, match=r"missing mask in .*00001.png; expected 3 masks"):
        open_segmentation(folder)


def test_a_mask_of_another_size_is_named(folder):
    Image.new("P", (4, 6)).save(folder / "masks" / "00002.png")
    with pytest.raises(InputError, match=r"mask of the wrong size in .*00002.png; got 4x6 px; expected 8x6 px"):
        open_segmentation(folder)


def test_a_mask_that_is_no_image_is_named(folder):
    (folder / "masks" / "00002.png").write_text("not a picture")
    with pytest.raises(InputError, match=r"mask cannot be decoded in .*00002.png"):
        open_segmentation(folder)


def test_an_object_that_the_summary_does_not_name_is_refused(folder):
    Image.fromarray(LABELS[0].astype(np.uint8) * 2).save(folder / "masks" / "00001.png")
    with pytest.raises(InputError, match=r"unknown object in .*00001.png; got identity 8"):
        list(open_segmentation(folder).labels())


@pytest.mark.parametrize("text", ["", "{", "[]", '{"name": "dog"}'])
def test_a_damaged_summary_is_one_line(folder, text):
    (folder / "motion.json").write_text(text)
    with pytest.raises(InputError, match=r"not a summary of motions in .*motion.json") as caught:
        open_segmentation(folder)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["../dog", "", ".."])
def test_a_name_with_a_folder_is_refused(folder, name):
    change(folder, name=name)
    with pytest.raises(InputError, match="not a name of a sequence"):
        open_segmentation(folder)


def test_names_of_frames_with_a_folder_are_refused(folder):
    change(folder, frames=["x.jpg", "../y.jpg", "z.jpg"])
    with pytest.raises(InputError, match=r"not a name of a frame in .*motion.json; got '../y.jpg'"):
        open_segmentation(folder)


def test_a_summary_that_claims_too_many_frames_is_refused_at_the_first_missing_mask(folder):
    change(folder, num_frames=2**62, frames=None)
    with pytest.raises(MissingInputError, match=r"missing mask in .*00003\.png; expected 4611686018427387904 masks"):
        open_segmentation(folder)
