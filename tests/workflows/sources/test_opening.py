import os

import numpy as np
import pytest

from schemas.errors import InputError, MissingInputError
from workflows.sources import ImageFiles, VideoFile, open_depth, open_frames, open_masks


@pytest.fixture
def frames(tmp_path, picture, write_image):
    for number in (1, 2, 10):
        write_image(tmp_path / "frames" / f"im{number}.png", np.roll(picture, number, 1))
    return open_frames(str(tmp_path / "frames"), 1000)


def names(paths):
    return [os.path.basename(path) for path in paths]


def test_a_folder_is_its_images_in_natural_order(tmp_path, frames, write_image, picture):
    write_image(tmp_path / "frames" / "._im1.jpg", picture)
    (tmp_path / "frames" / "notes.txt").write_text("not an image")
    assert names(open_frames(str(tmp_path / "frames"), 1000).paths) == ["im1.png", "im2.png", "im10.png"]


def test_mixed_suffixes_and_cases_are_one_sequence(tmp_path, write_image, picture):
    for name in ("0.jpg", "1.JPEG", "2.png", "3.BMP", "4.tif", "5.TIFF", "6.webp"):
        write_image(tmp_path / name, picture)
    source = open_frames(str(tmp_path), 1000)
    assert names(source.paths) == ["0.jpg", "1.JPEG", "2.png", "3.BMP", "4.tif", "5.TIFF", "6.webp"]
    assert len(list(source.read())) == 7


def test_two_images_of_one_stem_are_refused(tmp_path, frames, write_image, picture):
    write_image(tmp_path / "frames" / "im2.jpg", picture)
    with pytest.raises(InputError, match=r"im2\.jpg and im2\.png"):
        open_frames(str(tmp_path / "frames"), 1000)


def test_a_file_is_a_video_and_an_image_a_frame(tmp_path, frames, write_video, picture):
    path = write_video(tmp_path / "a.mp4", [picture])
    assert open_frames(path, 99) == VideoFile(path, 99)
    assert open_frames(frames.paths[0], 99) == ImageFiles(frames.paths[:1], 99)


def test_paths_hold_wherever_they_are_read(tmp_path, frames, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert open_frames("frames", 1000) == frames


def test_what_is_not_there_is_said(tmp_path):
    with pytest.raises(MissingInputError, match=r"gone; expected a video or a folder"):
        open_frames(str(tmp_path / "gone"), 1000)
    with pytest.raises(MissingInputError, match="no images"):
        open_frames(str(tmp_path), 1000)
    (tmp_path / "notes.txt").write_text("no image")
    with pytest.raises(MissingInputError, match="no images"):
        open_frames(str(tmp_path), 1000)


def test_masks_match_frames_by_stem(tmp_path, frames, write_image):
    for number in (10, 2):
        write_image(tmp_path / "masks" / f"im{number}.png", np.full((48, 64), number, np.uint8))
    masks = open_masks(str(tmp_path / "masks"), frames)
    assert masks.kind == "instance"
    assert [(index, labels.max()) for index, labels in masks.read()] == [(1, 2), (2, 10)]


def test_masks_keep_the_size_of_frames_that_are_reduced(tmp_path, frames, write_image):
    write_image(tmp_path / "masks" / "im1.png", np.ones((48, 64), np.uint8))
    masks = open_masks(str(tmp_path / "masks"), ImageFiles(frames.paths, 32))
    assert next(masks.read())[1].shape == (48, 64)
    write_image(tmp_path / "masks" / "im2.png", np.ones((24, 32), np.uint8))
    with pytest.raises(InputError, match=r"im2\.png; got 32x24 px; expected 64x48 px"):
        list(open_masks(str(tmp_path / "masks"), ImageFiles(frames.paths, 32)).read())


def test_a_mask_without_a_frame_is_named(tmp_path, frames, write_image):
    write_image(tmp_path / "masks" / "im3.png", np.ones((48, 64), np.uint8))
    with pytest.raises(InputError, match=r"without a frame in .*im3\.png"):
        open_masks(str(tmp_path / "masks"), frames)


def test_masks_of_a_video_are_numbered(tmp_path, write_image, write_video, picture):
    video = open_frames(write_video(tmp_path / "a.mp4", [picture] * 3), 1000)
    for name in ("00000.png", "00002.png"):
        write_image(tmp_path / "masks" / name, np.ones((48, 64), np.uint8))
    assert [index for index, _ in open_masks(str(tmp_path / "masks"), video).items] == [0, 2]
    write_image(tmp_path / "masks" / "2.png", np.ones((48, 64), np.uint8))
    with pytest.raises(InputError, match="two masks of frame 2"):
        open_masks(str(tmp_path / "masks"), video)
    write_image(tmp_path / "masks" / "first.png", np.ones((48, 64), np.uint8))
    with pytest.raises(InputError, match=r"first\.png; expected the number of a frame"):
        open_masks(str(tmp_path / "masks"), video)


def test_no_masks_are_said(tmp_path, frames):
    with pytest.raises(MissingInputError, match="no masks"):
        open_masks(str(tmp_path), frames)
    with pytest.raises(MissingInputError, match="does not exist"):
        open_masks(str(tmp_path / "gone"), frames)
    with pytest.raises(InputError, match="not a folder"):
        open_masks(frames.paths[0], frames)


def test_depth_is_counted_against_the_frames(tmp_path, frames):
    (tmp_path / "depth").mkdir()
    for number in range(3):
        np.save(tmp_path / "depth" / f"{number}.npy", np.full((48, 64), float(number)))
    depth = open_depth(str(tmp_path / "depth"), frames, 3, 32)
    assert [array.max() for array in depth.read()] == [0, 1, 2]
    assert next(depth.read()).shape == (24, 32)
    with pytest.raises(InputError, match="got 3; expected 4 files"):
        open_depth(str(tmp_path / "depth"), frames, 4, 32)
