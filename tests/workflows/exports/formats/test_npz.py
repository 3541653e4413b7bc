"""The archive loads without pickle and holds the labels."""

import numpy as np

from moseg.workflows.exports.formats import FORMATS
from moseg.workflows.predictions import FrameList, open_predictions


def test_arrays_are_those_that_were_saved(saved, volume):
    path = FORMATS["npz"].write(saved, saved.folder, None)
    assert path == saved.folder / "dog walk.npz"
    with np.load(path, allow_pickle=False) as archive:
        arrays = dict(archive)
    assert (arrays["labels"].dtype, arrays["labels"].flags.c_contiguous) == (np.uint16, True)
    np.testing.assert_array_equal(arrays["labels"], volume)
    assert (arrays["identities"].tolist(), arrays["motions"].tolist()) == ([2, 7], [1, 2])
    assert arrays["tags"].tolist() == ["dog", ""]
    assert arrays["names"].tolist() == ["a 1.jpg", "b.png", "größe.JPG", "犬.webp"]
    assert arrays["fps"] == 25


def test_objects_have_the_names_that_the_user_gave(write_saved):
    saved = write_saved(tags={2: "dog", 7: "cat"}, given_names={7: "größte Katze"})
    with np.load(FORMATS["npz"].write(saved, saved.folder, None), allow_pickle=False) as archive:
        assert archive["tags"].tolist() == ["dog", "größte Katze"]


def test_it_is_read_as_predictions(saved, volume):
    FORMATS["npz"].write(saved, saved.folder, None)
    read = open_predictions(saved.folder, "volume").sequence("dog walk", FrameList(4), volume.shape[1:])
    for index, labels in enumerate(volume):
        np.testing.assert_array_equal(read.frame(index), labels)


def test_the_same_labels_give_the_same_bytes_and_compress(write_saved):
    saved = write_saved(labels=np.zeros((50, 40, 40), np.uint16))
    first = FORMATS["npz"].write(saved, saved.folder, None).read_bytes()
    assert FORMATS["npz"].write(saved, saved.folder, None).read_bytes() == first
    assert len(first) < 50 * 40 * 40


def test_a_still_video_has_no_identities(write_saved, volume):
    saved = write_saved(labels=volume * 0)
    with np.load(FORMATS["npz"].write(saved, saved.folder, None), allow_pickle=False) as archive:
        assert archive["identities"].shape == archive["motions"].shape == archive["tags"].shape == (0,)
