"""Ignore masks have the names, values and dilation that each program expects."""

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.exports.formats import FORMATS

PNG_NAMES = tuple(f"{index}.png" for index in range(4))


def read(folder):
    """Values of every mask by name; each must be 8-bit grey."""
    masks = {}
    for path in sorted(folder.glob("*.*")):
        if not path.name.startswith("."):
            with Image.open(path) as image:
                assert (image.format, image.mode) == ("PNG", "L")
                masks[path.name] = np.asarray(image)
    return masks


NAMES = {
    "colmap": ["a 1.jpg.png", "b.png.png", "größe.JPG.png", "犬.webp.png"],
    "nerfstudio": ["a 1.png", "b.png", "größe.png", "犬.png"],
    "instant-ngp": ["dynamic_mask_a 1.png", "dynamic_mask_b.png", "dynamic_mask_größe.png", "dynamic_mask_犬.png"],
}
IGNORED_AND_USED = {"colmap": (0, 255), "nerfstudio": (0, 255), "instant-ngp": (255, 0), "dynaslam": (1, 0)}


@pytest.mark.parametrize("name", NAMES)
def test_masks_are_named_after_the_frames(saved, name):
    folder = FORMATS[name].write(saved, saved.folder, None)
    assert list(read(folder)) == NAMES[name]


@pytest.mark.parametrize("name", IGNORED_AND_USED)
def test_moving_pixels_are_ignored_and_the_rest_used(write_saved, volume, name):
    saved = write_saved(frames=PNG_NAMES)
    masks = read(FORMATS[name].write(saved, saved.folder, 0))
    ignored, used = IGNORED_AND_USED[name]
    for mask, labels in zip(masks.values(), volume, strict=True):
        np.testing.assert_array_equal(mask, np.where(labels > 0, ignored, used))


@pytest.mark.parametrize("name", IGNORED_AND_USED)
def test_a_dilation_has_its_radius_in_every_direction(write_saved, name):
    point = np.zeros((1, 21, 31), dtype=np.uint16)
    point[0, 10, 15] = 3
    saved = write_saved(labels=point, frames=("0.png",))
    (mask,) = read(FORMATS[name].write(saved, saved.folder, 4)).values()
    y, x = np.mgrid[:21, :31]
    np.testing.assert_array_equal(mask == IGNORED_AND_USED[name][0], np.hypot(y - 10, x - 15) <= 4)


@pytest.mark.parametrize("name", NAMES)
def test_by_default_borders_are_ignored_too(saved, volume, name):
    first = next(iter(read(FORMATS[name].write(saved, saved.folder, None)).values()))
    assert np.count_nonzero(first == IGNORED_AND_USED[name][0]) > np.count_nonzero(volume[0])


def test_masks_of_dynaslam_are_not_dilated_and_have_the_names_of_png_frames(write_saved, saved, volume):
    with pytest.raises(InputError, match=r"not a PNG file in dynaslam; got a 1\.jpg"):
        FORMATS["dynaslam"].write(saved, saved.folder, None)
    saved = write_saved(frames=PNG_NAMES)
    masks = read(FORMATS["dynaslam"].write(saved, saved.folder, None))
    assert list(masks) == list(PNG_NAMES)
    np.testing.assert_array_equal(masks["0.png"] > 0, volume[0] > 0)


def test_frames_of_a_video_are_named_as_ffmpeg_numbers_them(write_saved):
    saved = write_saved()
    assert list(read(FORMATS["colmap"].write(saved, saved.folder, 0))) == [f"{index:05d}.png.png" for index in range(4)]


def test_a_dilation_below_zero_is_refused(saved):
    with pytest.raises(InputError, match="impossible dilation; got -1"):
        FORMATS["colmap"].write(saved, saved.folder, -1)
