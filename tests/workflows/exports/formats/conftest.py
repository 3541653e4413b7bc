"""A small segmentation on disk, as `moseg segment` leaves it."""

import numpy as np
import pytest

from moseg.workflows.exports import summarise_sequence, write_masks, write_motion
from moseg.workflows.exports.saved_segmentation import open_segmentation

HEIGHT, WIDTH = 12, 17


@pytest.fixture
def volume():
    """Labels of four frames: identity 2 in all but the third, which is still, and identity 7 in two, before it."""
    volume = np.zeros((4, HEIGHT, WIDTH), dtype=np.uint16)
    for index in (0, 1, 3):
        volume[index, 2:7, 1 + index : 6 + index] = 2
    volume[:2, 5:11, 4:12] = 7
    return volume


@pytest.fixture
def write_saved(tmp_path, volume):
    """Write the labels and open them, with other labels, names of frames, tags or names of objects where given."""

    def write(labels=volume, frames=None, tags=None, name="dog walk", given_names=None):
        folder = tmp_path / "out"
        write_masks(folder / "masks", labels)
        motions = {identity: 1 + identity % 2 for identity in np.unique(labels).tolist() if identity}
        summary = summarise_sequence(name, labels, 25.0, 3, motions, tags, frames, given_names=given_names)
        write_motion(folder / "motion.json", summary)
        return open_segmentation(folder)

    return write


@pytest.fixture
def saved(write_saved):
    """With names of frames that hold a space and letters beyond ASCII."""
    return write_saved(frames=("a 1.jpg", "b.png", "größe.JPG", "犬.webp"), tags={2: "dog"})
