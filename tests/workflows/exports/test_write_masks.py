"""Masks are read from their files unchanged."""

import os
import uuid

import cv2
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.exports import davis_palette, identity_colours, write_masks
from moseg.workflows.predictions import FrameList, open_predictions


@pytest.fixture
def labels():
    volume = np.zeros((3, 7, 10), dtype=np.uint16)
    volume[:, 1:4, 1:5] = 1
    volume[1:, 3:6, 4:9] = 254
    return volume


def test_palette_begins_as_that_of_davis():
    expected = [(0, 0, 0), (128, 0, 0), (0, 128, 0), (128, 128, 0), (0, 0, 128), (128, 0, 128), (0, 128, 128)]
    expected += [(128, 128, 128), (64, 0, 0), (192, 0, 0)]
    assert [tuple(colour) for colour in davis_palette()[:10].tolist()] == expected
    assert davis_palette()[255].tolist() == [224, 224, 192]
    assert len(np.unique(davis_palette(), axis=0)) == 256


def test_written_masks_hold_the_identities_and_the_palette(tmp_path, labels):
    assert write_masks(tmp_path / "out" / "dog" / "masks", iter(labels)) == 3
    with Image.open(tmp_path / "out" / "dog" / "masks" / "00001.png") as image:
        assert image.mode == "P"
        np.testing.assert_array_equal(np.reshape(image.getpalette(), (256, 3)), davis_palette())
        np.testing.assert_array_equal(np.asarray(image), labels[1])


def test_written_masks_are_read_as_predictions(tmp_path, labels):
    labels[2, 0, 0] = 40_000
    labels[1, 0, 0] = 255
    write_masks(tmp_path / "dog" / "masks", labels)
    sequence = open_predictions(tmp_path).sequence("dog", FrameList(3), (7, 10))
    for index, frame in enumerate(labels):
        np.testing.assert_array_equal(sequence.frame(index), frame)


def test_only_frames_with_many_identities_lose_the_palette(tmp_path, labels):
    labels[2, 0, 0] = 255
    write_masks(tmp_path, labels)
    modes = []
    for path in sorted(tmp_path.iterdir()):
        with Image.open(path) as image:
            modes.append(image.mode)
    assert modes == ["P", "P", "I;16"]


def test_a_shorter_run_removes_the_frames_of_a_longer_one_and_nothing_else(tmp_path, labels):
    write_masks(tmp_path, labels)
    (tmp_path / "notes.txt").write_text("kept")
    (tmp_path / "cover.png").write_bytes(b"kept")
    write_masks(tmp_path, labels[:1])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["00000.png", "cover.png", "notes.txt"]


def test_half_written_files_of_a_killed_run_are_removed_and_those_of_a_running_one_are_not(tmp_path, labels):
    left = tmp_path / f".{uuid.uuid4().hex}.part"
    others = [f".{uuid.uuid4().hex}.part", f"{uuid.uuid4().hex}.part", ".00019.png.part", ".00020.png.part.png"]
    for name in (left.name, *others):
        (tmp_path / name).write_bytes(b"half")

    def frames():
        yield labels[0]
        (tmp_path / others[0]).write_bytes(b"half and more")
        yield labels[1]

    write_masks(tmp_path, frames())
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*others, "00000.png", "00001.png"])


def test_an_identity_keeps_its_colour_and_none_is_black():
    labels = np.array([1, 2, 255, 256, 65535], dtype=np.uint16)
    np.testing.assert_array_equal(identity_colours(labels), np.stack([identity_colours(each) for each in labels]))
    assert identity_colours(np.arange(1, 2**16)).any(axis=-1).all()
    assert not identity_colours(np.zeros(1, np.uint16)).any()


@pytest.mark.parametrize(("num_objects", "least"), [(8, 50), (16, 35), (32, 25)])
def test_colours_of_objects_can_be_told_apart(num_objects, least):
    # Distances in CIELAB; a just noticeable one is about 2.3. The palette of DAVIS, at full brightness, has 0.
    colours = identity_colours(np.arange(1, num_objects + 1)).astype(np.float32) / 255
    places = cv2.cvtColor(colours[None], cv2.COLOR_RGB2Lab)[0]
    distances = np.linalg.norm(places[:, None] - places, axis=-1) + 1000 * np.eye(num_objects)
    assert distances.min() > least


def test_a_folder_that_cannot_be_created_is_named(tmp_path, labels):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot write in .*file/masks; got Not a directory"):
        write_masks(tmp_path / "file" / "masks", labels)


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser writes everywhere")
def test_a_folder_without_permission_is_named(tmp_path, labels):
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match=r"cannot write in .*00000.png; got Permission denied"):
        write_masks(tmp_path, labels)
    tmp_path.chmod(0o700)


def test_a_failure_of_the_source_leaves_no_half_file_and_is_not_blamed_on_the_output(tmp_path, labels):
    def source():
        yield labels[0]
        raise OSError("the source broke")

    with pytest.raises(OSError, match="the source broke"):
        write_masks(tmp_path, source())
    assert [path.name for path in tmp_path.iterdir()] == ["00000.png"]
