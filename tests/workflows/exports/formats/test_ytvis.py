"""A file of YouTube-VIS holds one annotation for each object, with a mask or nothing for each frame."""

import json

import numpy as np
import pytest
from pycocotools import mask as coco_mask

from moseg.workflows.exports.formats import FORMATS

# pycocotools decodes into a class whose __array__ takes no copy argument, which NumPy 2 asks for.
pytestmark = pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")


@pytest.fixture
def content(saved):
    return json.loads(FORMATS["ytvis"].write(saved, saved.folder, None).read_text(encoding="utf-8"))


def test_masks_decode_to_the_labels(content, volume):
    found = np.zeros_like(volume)
    for annotation in content["annotations"]:
        for index, runs in enumerate(annotation["segmentations"]):
            if runs is not None:
                found[index][coco_mask.decode(runs) > 0] = annotation["id"]
    np.testing.assert_array_equal(found, volume)


def test_the_lists_have_an_entry_a_frame_and_null_where_the_object_is_hidden(content):
    seen = {2: [True, True, False, True], 7: [True, True, False, False]}
    for annotation in content["annotations"]:
        for name in ("segmentations", "bboxes", "areas"):
            assert [value is not None for value in annotation[name]] == seen[annotation["id"]]


def test_the_video_lists_its_frames_in_its_folder(content):
    (video,) = content["videos"]
    assert (video["length"], video["width"], video["height"]) == (4, 17, 12)
    assert video["file_names"][0] == "dog walk/a 1.jpg"
    assert {annotation["video_id"] for annotation in content["annotations"]} == {video["id"]}
    assert {annotation["category_id"] for annotation in content["annotations"]} <= {
        category["id"] for category in content["categories"]
    }
