import os

import numpy as np
import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources import ImageFiles, VideoFile, open_depth, open_flow, open_frames, open_masks


@pytest.fixture
def frames(tmp_path, picture, write_image):
    for number in (1, 2, 10):
        write_image(tmp_path / "frames" / f"im{number}.png", np.roll(picture, number, 1))
    return open_frames(str(tmp_path / "frames"), 1000)


def names(paths):
    return [os.path.basename(path) for path in paths]


def test_images_of_a_folder_are_read_in_natural_order(tmp_path, frames, write_image, picture):
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


def test_a_single_file_is_a_video_or_one_image(tmp_path, frames, write_video, picture):
    path = write_video(tmp_path / "a.mp4", [picture])
    assert open_frames(path, 99) == VideoFile(path, 99)
    assert open_frames(frames.paths[0], 99) == ImageFiles(frames.paths[:1], 99)


def test_paths_do_not_depend_on_the_working_folder(tmp_path, frames, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert open_frames("frames", 1000) == frames


def test_missing_paths_are_named(tmp_path):
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


def _write_masks(folder, write_image, *stems):
    for label, name in enumerate(stems, start=1):
        write_image(folder / f"{name}.png", np.full((48, 64), label, np.uint8))
    return str(folder)


def test_masks_of_some_frames_of_a_video_are_numbered_from_0(tmp_path, write_image, write_video, picture):
    video = open_frames(write_video(tmp_path / "a.mp4", [picture] * 4), 1000)
    masks = open_masks(_write_masks(tmp_path / "masks", write_image, "00000", "00002"), video)
    assert [index for index, _ in masks.items] == [0, 2]
    for name, words in (("2", "two files of frame 2"), ("first", "without a frame"), ("00004", "without a frame")):
        folder = _write_masks(tmp_path / name, write_image, "00000", "00002", name)
        with pytest.raises(InputError, match=words):
            open_masks(folder, video)


@pytest.mark.parametrize("start", [0, 1])
def test_a_mask_for_each_frame_of_a_video_may_be_numbered_from_0_or_1(
    tmp_path, write_image, write_video, picture, start
):
    video = open_frames(write_video(tmp_path / "a.mp4", [picture] * 3), 1000)
    masks = open_masks(_write_masks(tmp_path / "masks", write_image, *(start + index for index in range(3))), video)
    assert [(index, labels.max()) for index, labels in masks.read()] == [(0, 1), (1, 2), (2, 3)]


@pytest.mark.parametrize("names", [("00002", "2", "0"), ("0", "1", "overview")])
def test_as_many_masks_as_frames_of_a_video_are_refused_where_one_is_doubtful(
    tmp_path, write_image, write_video, picture, names
):
    video = open_frames(write_video(tmp_path / "a.mp4", [picture] * 3), 1000)
    with pytest.raises(InputError, match=r"two files of frame 2|without a frame in .*masks; got overview"):
        open_masks(_write_masks(tmp_path / "masks", write_image, *names), video)


def test_a_folder_without_masks_is_named(tmp_path, frames):
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


def _write_depth(folder, *stems):
    folder.mkdir()
    for label, name in enumerate(stems):
        np.save(folder / f"{name}.npy", np.full((48, 64), float(label)))
    return str(folder)


@pytest.mark.parametrize("names", [("im1", "im2", "im10"), ("0", "1", "2"), ("1", "2", "3"), ("a", "b", "c")])
def test_depth_is_named_as_the_frames_or_in_their_order(tmp_path, frames, names):
    depth = open_depth(_write_depth(tmp_path / "depth", *names), frames, 3, 1000)
    assert [array.max() for array in depth.read()] == [0, 1, 2]


def test_depth_of_which_one_map_is_of_no_frame_is_named(tmp_path, frames):
    with pytest.raises(InputError, match=r"only some .* in .*depth; got im1, which is a frame, and im7, which is none"):
        open_depth(_write_depth(tmp_path / "depth", "im1", "im2", "im7"), frames, 3, 1000)


@pytest.fixture
def counted_frames(tmp_path, write_image, picture):
    for number in range(5, 10):
        write_image(tmp_path / "counted" / f"{number:05d}.png", picture)
    return open_frames(str(tmp_path / "counted"), 1000)


def _write_flow(folder, *stems):
    folder.mkdir()
    for label, name in enumerate(stems):
        np.save(folder / f"{name}.npy", np.full((48, 64, 2), float(label)))
    return str(folder)


@pytest.mark.parametrize(
    "names",
    [
        ("00005", "00006", "00007", "00008"),
        ("00006", "00007", "00008", "00009"),
        ("00000", "00001", "00002", "00003"),
        ("00001", "00002", "00003", "00004"),
        ("a", "b", "c", "d"),
        ("5_6", "6_7", "7_8", "8_9"),
    ],
)
def test_flow_is_one_field_a_pair_in_order(tmp_path, counted_frames, names):
    flow = open_flow(_write_flow(tmp_path / "flow", *names), counted_frames, 5, 1000)
    assert [array.max() for array in flow.read()] == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("00005", "00006", "00008", "00009"), "none named 00007"),
        (("flow_0", "flow_1", "flow_3", "flow_4"), "flow_1, then flow_3"),
        (("00002", "00003", "00004", "00005"), "00005, which is a frame, and 00002, which is none"),
        (("00005", "00006", "00007", "00010"), "00005, which is a frame, and 00010, which is none"),
    ],
)
def test_a_gap_in_the_flow_is_named(tmp_path, counted_frames, names, words):
    with pytest.raises(InputError, match=words):
        open_flow(_write_flow(tmp_path / "flow", *names), counted_frames, 5, 1000)


def test_flow_of_frames_with_gaps_may_have_the_same(tmp_path, frames):
    assert len(open_flow(_write_flow(tmp_path / "flow", "im1_im2", "im2_im10"), frames, 3, 1000).paths) == 2
