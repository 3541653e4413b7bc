"""Frames that are very large, very small or very narrow: analysed at `max_side`, labelled at their own size."""

import resource

import numpy as np
import pytest
from PIL import Image

MEMORY_OF_8K = 700 * 2**20
"""Bytes by which the peak may rise: a frame of 8K takes 100 MB decoded, and is there a few times over."""


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (5, 5), (16, 16), (3, 200), (200, 3), (33, 17)])
def test_tiny_and_narrow_frames_give_masks_of_their_size(masks_of, write_folder, scene, size):
    assert masks_of(write_folder(images=scene(*size))).shape == (5, *size)


@pytest.fixture
def large_frames(write_folder, scene):
    """Two frames of 8K."""
    images = [image.repeat(90, axis=0).repeat(120, axis=1)[:4320, :7680] for image in scene(48, 64)[:2]]
    return write_folder(
        images=images, save=lambda image, path: Image.fromarray(image).save(path, quality=80), suffix=".jpg"
    )


def test_8k_frames_are_analysed_small_and_labelled_at_full_size(masks_of, large_frames, tmp_path):
    import av

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    masks = masks_of(large_frames, "--set", "max_side=64")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert masks.shape == (2, 4320, 7680)
    # What the test itself holds, two bytes a pixel, counts for nothing.
    assert (peak - before) * 1024 < MEMORY_OF_8K + 2 * masks.nbytes
    with av.open(str(tmp_path / "out" / "overlay.mp4")) as overlay:
        stream = overlay.streams.video[0]
        assert (stream.width, stream.height) == (64, 36)


def test_labels_of_reduced_frames_lie_where_the_objects_are(masks_of, write_folder, scene):
    images = scene(96, 128)
    folder = write_folder(images=images)
    reduced, whole = masks_of(folder, "--set", "max_side=64"), masks_of(folder)
    assert reduced.shape == whole.shape == (5, 96, 128)
    both = np.count_nonzero((reduced > 0) & (whole > 0))
    assert both > 0.5 * np.count_nonzero((reduced > 0) | (whole > 0)) > 0


@pytest.mark.parametrize("value", ["15", "0", "-64", "nan", "large", ""])
def test_a_max_side_that_is_none_is_refused(refuse, write_folder, value):
    refuse(write_folder(), "max_side", options=("--set", f"max_side={value}"))
