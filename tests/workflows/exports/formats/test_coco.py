"""COCO's own reader finds every object of every frame, with unchanged masks."""

import json

import numpy as np
import pytest
from pycocotools.coco import COCO

from moseg.workflows.exports.formats import FORMATS

# pycocotools decodes into a class whose __array__ takes no copy argument, which NumPy 2 asks for.
pytestmark = pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")


@pytest.fixture
def coco(saved):
    return COCO(str(FORMATS["coco"].write(saved, saved.folder, None)))


def test_masks_decode_to_the_labels(coco, volume):
    for image, labels in zip(coco.loadImgs(coco.getImgIds()), volume, strict=True):
        found = np.zeros_like(labels)
        for annotation in coco.loadAnns(coco.getAnnIds(image["id"])):
            found[coco.annToMask(annotation) > 0] = annotation["track_id"]
        np.testing.assert_array_equal(found, labels)


def test_images_have_the_frames_names_and_size(coco):
    images = coco.loadImgs(coco.getImgIds())
    assert [image["file_name"] for image in images] == ["a 1.jpg", "b.png", "größe.JPG", "犬.webp"]
    assert {(image["width"], image["height"]) for image in images} == {(17, 12)}
    assert len(coco.getImgIds()) == len({image["id"] for image in images}) == 4


def test_boxes_and_areas_are_those_of_the_masks(coco):
    for annotation in coco.loadAnns(coco.getAnnIds()):
        mask = coco.annToMask(annotation)
        rows, columns = np.nonzero(mask)
        x, y, width, height = annotation["bbox"]
        assert (x, y, x + width, y + height) == (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        assert (annotation["area"], annotation["iscrowd"]) == (mask.sum(), 0)


def test_categories_are_the_tags_and_objects_without_one_are_moving_objects(coco):
    names = {category["id"]: category["name"] for category in coco.loadCats(coco.getCatIds())}
    of_track = {entry["track_id"]: names[entry["category_id"]] for entry in coco.loadAnns(coco.getAnnIds())}
    assert of_track == {2: "dog", 7: "moving object"}


def test_a_still_video_has_images_and_a_category_and_no_annotation(write_saved, volume):
    saved = write_saved(labels=volume * 0)
    coco = COCO(str(FORMATS["coco"].write(saved, saved.folder, None)))
    assert (len(coco.getImgIds()), coco.getAnnIds()) == (4, [])
    assert [entry["name"] for entry in coco.loadCats(coco.getCatIds())] == ["moving object"]


def test_the_file_is_strict_json_that_reads_as_text(saved):
    text = FORMATS["coco"].write(saved, saved.folder, None).read_text(encoding="utf-8")
    assert "größe.JPG" in text
    assert all(isinstance(entry["segmentation"]["counts"], str) for entry in json.loads(text)["annotations"])


@pytest.mark.parametrize("form", ["coco", "ytvis"])
def test_the_users_name_of_an_object_is_its_category(write_saved, form):
    saved = write_saved(tags={2: "dog", 7: "cat"}, given_names={2: 'Rex, "the dog"'})
    content = json.loads(FORMATS[form].write(saved, saved.folder, None).read_text())
    names = {each["id"]: each["name"] for each in content["categories"]}
    key = "track_id" if form == "coco" else "id"
    assert {each[key]: names[each["category_id"]] for each in content["annotations"]} == {
        2: 'Rex, "the dog"',
        7: "cat",
    }
