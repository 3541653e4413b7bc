"""Masks in the folders of DAVIS hold the identities as palette indices."""

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.exports import davis_palette
from moseg.workflows.exports.formats import FORMATS, export
from moseg.workflows.predictions import FrameList, open_predictions


def test_palette_indices_are_the_identities(saved, volume):
    folder = FORMATS["davis"].write(saved, saved.folder, None)
    assert folder == saved.folder / "davis" / "dog walk"
    for name, labels in zip(("a 1", "b", "größe", "犬"), volume, strict=True):
        with Image.open(folder / f"{name}.png") as image:
            assert image.mode == "P"
            np.testing.assert_array_equal(np.reshape(image.getpalette(), (256, 3)), davis_palette())
            np.testing.assert_array_equal(np.asarray(image), labels)


def test_they_are_read_as_predictions(write_saved, volume):
    saved = write_saved(frames=tuple(f"{index:05d}.jpg" for index in range(4)))
    FORMATS["davis"].write(saved, saved.folder, None)
    read = open_predictions(saved.folder / "davis").sequence("dog walk", FrameList(4), volume.shape[1:])
    for index, labels in enumerate(volume):
        np.testing.assert_array_equal(read.frame(index), labels)


def test_more_objects_than_a_palette_holds_are_refused_before_any_format_is_written(write_saved, volume):
    volume[0, 0, 0] = 255
    saved = write_saved(labels=volume)
    with pytest.raises(InputError, match="too many objects for a palette in davis; got 255; expected at most 254"):
        export(saved, (FORMATS["coco"], FORMATS["davis"]), saved.folder)
    assert sorted(path.name for path in saved.folder.iterdir()) == ["masks", "motion.json"]
