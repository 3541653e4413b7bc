"""Frames and masks as one set: names that match, black where something moves, and thinned alike."""

import io
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image, ImageCms, ImageOps

from moseg.schemas.errors import InputError
from moseg.workflows.cli.export import OWN_SETS
from moseg.workflows.config.frame_range import Position
from moseg.workflows.exports.formats import export
from moseg.workflows.exports.formats.reconstruction_sets import SETS, choose_kept, choose_sets
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.sources import ImageFiles, VideoFile

HEIGHT, WIDTH, NUM_FRAMES = 24, 32, 6


@pytest.fixture
def labels():
    labels = np.zeros((NUM_FRAMES, HEIGHT, WIDTH), np.uint16)
    for index in range(NUM_FRAMES):
        labels[index, 8:14, 2 + index * 4 : 8 + index * 4] = 1
    return labels


@pytest.fixture
def images(tmp_path):
    """Return the paths of frames in several formats, each of its own grey level."""
    folder = tmp_path / "frames"
    folder.mkdir()
    names = ["a0.png", "a1.JPG", "a2.png", "a3.jpeg", "a4.png", "a5.bmp"]
    for index, name in enumerate(names):
        Image.fromarray(np.full((HEIGHT, WIDTH, 3), 40 * index, np.uint8)).save(folder / name)
    return [folder / name for name in names]


@pytest.fixture
def saved(write_saved, labels, images):
    origin = FrameOrigin(str(images[0].parent), ImageFiles(tuple(map(str, images)), 1000))
    return write_saved(labels, tuple(path.name for path in images)).from_video(origin)


def _grey(path):
    return np.asarray(Image.open(path).convert("L"))


def test_the_programs_are_those_of_the_command_line():
    assert tuple(SETS) == OWN_SETS
    with pytest.raises(InputError, match="did you mean 'colmap'"):
        choose_sets(["colmpa"])


def test_colmap_finds_the_mask_of_each_image_by_its_name(saved, labels, images, tmp_path):
    (folder,) = export(saved, choose_sets(["colmap"]), tmp_path, 0)
    assert folder == tmp_path / "for-colmap"
    assert sorted(path.name for path in (folder / "images").iterdir()) == sorted(path.name for path in images)
    for path, mask in zip(images, labels, strict=True):
        assert (folder / "images" / path.name).read_bytes() == path.read_bytes()
        np.testing.assert_array_equal(_grey(folder / "masks" / f"{path.name}.png"), np.where(mask > 0, 0, 255))
    assert len(list((folder / "masks").iterdir())) == NUM_FRAMES


def test_nerfstudio_keeps_the_names_of_the_masks(saved, labels, tmp_path):
    (folder,) = export(saved, choose_sets(["nerfstudio"]), tmp_path, 0)
    names = sorted(path.name for path in (folder / "images").iterdir())
    suffixes = (".png", ".jpg", ".png", ".jpeg", ".png", ".bmp")
    assert names == [f"frame_{index + 1:05d}{suffix}" for index, suffix in enumerate(suffixes)]
    for index, name in enumerate(names):
        assert abs(int(_grey(folder / "images" / name)[0, 0]) - 40 * index) < 3
        mask = _grey(folder / "masks" / f"{Path(name).stem}.png")
        np.testing.assert_array_equal(mask, np.where(labels[index] > 0, 0, 255))


def test_masks_are_widened_by_default(saved, tmp_path):
    (folder,) = export(saved, choose_sets(["colmap"]), tmp_path)
    assert (_grey(folder / "masks" / "a0.png.png") == 0).sum() > 3 * 36


@pytest.mark.parametrize(
    ("step", "kept"), [(Position(2, False), (0, 2, 4)), (Position(0.3, True), (0, 3)), (Position(9, False), (0,))]
)
def test_a_thinned_set_has_the_frames_and_masks_of_the_same_frames(saved, labels, images, tmp_path, step, kept):
    assert choose_kept(saved.origin, NUM_FRAMES, step, 10) == kept
    (folder,) = export(saved.thin(kept), choose_sets(["colmap"]), tmp_path, 0)
    assert {path.name for path in (folder / "images").iterdir()} == {images[index].name for index in kept}
    for index in kept:
        mask = _grey(folder / "masks" / f"{images[index].name}.png")
        np.testing.assert_array_equal(mask, np.where(labels[index] > 0, 0, 255))
    # A second set leaves none of the first behind.
    export(saved.thin((1,)), choose_sets(["colmap"]), tmp_path)
    assert [path.name for path in (folder / "images").iterdir()] == ["a1.JPG"]
    assert [path.name for path in (folder / "masks").iterdir()] == ["a1.JPG.png"]


def test_a_time_of_images_needs_a_rate(saved):
    with pytest.raises(InputError, match=r"a time needs a frame rate.*--fps"):
        choose_kept(saved.origin, NUM_FRAMES, Position(0.3, True), None)


def test_frames_of_a_part_of_a_video_are_those_of_its_masks(write_saved, labels, tmp_path):
    path, levels = tmp_path / "video.mkv", [10 * number for number in range(20)]
    with av.open(str(path), "w") as container:
        stream = container.add_stream("ffv1", rate=10)
        stream.height, stream.width, stream.pix_fmt = HEIGHT, WIDTH, "bgr0"
        for level in levels:
            image = np.full((HEIGHT, WIDTH, 3), level, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode(None))
    origin = FrameOrigin(str(path), VideoFile(str(path), 8, (3, 5, 7, 9, 11, 13)))
    saved = write_saved(labels).from_video(origin)
    kept = choose_kept(origin, NUM_FRAMES, Position(0.4, True), None)
    assert kept == (0, 2, 4)
    (folder,) = export(saved.thin(kept), choose_sets(["colmap"]), tmp_path, 0)
    shown = {path.name: int(_grey(path)[0, 0]) for path in (folder / "images").iterdir()}
    assert shown == {"00000.png": 30, "00002.png": 70, "00004.png": 110}
    assert _grey(folder / "images" / "00000.png").shape == (HEIGHT, WIDTH)
    np.testing.assert_array_equal(_grey(folder / "masks" / "00002.png.png"), np.where(labels[2] > 0, 0, 255))


def test_a_photograph_that_exif_turns_is_written_upright(write_saved, labels, images, tmp_path):
    turned = Image.fromarray(np.full((WIDTH, HEIGHT, 3), 90, np.uint8))
    turned.paste((255, 255, 255), (0, 0, HEIGHT, 4))
    exif = turned.getexif()
    exif[0x0112] = 6
    content = io.BytesIO()
    turned.save(content, "JPEG", exif=exif, quality=95)
    images[1].write_bytes(content.getvalue())
    origin = FrameOrigin(str(images[0].parent), ImageFiles(tuple(map(str, images)), 1000))
    saved = write_saved(labels, tuple(path.name for path in images)).from_video(origin)
    (folder,) = export(saved, choose_sets(["colmap"]), tmp_path)
    with Image.open(folder / "images" / "a1.JPG") as image:
        assert image.size == (WIDTH, HEIGHT)
        assert image.getexif().get(0x0112, 1) == 1
        # Orientation 6 is shown after a quarter turn to the right: its first row is the last column.
        assert np.asarray(image)[:, -2].min() > 220 and np.asarray(image)[:, 2].max() < 120


def test_frames_that_do_not_fit_are_refused(write_saved, labels, images, tmp_path):
    Image.fromarray(np.zeros((HEIGHT, WIDTH + 1, 3), np.uint8)).save(images[2])
    origin = FrameOrigin(str(images[0].parent), ImageFiles(tuple(map(str, images)), 1000))
    saved = write_saved(labels, tuple(path.name for path in images))
    with pytest.raises(InputError, match=r"image of the wrong size in .*a2.png"):
        export(saved.from_video(origin), choose_sets(["colmap"]), tmp_path)
    with pytest.raises(InputError, match="masks and frames differ in number"):
        saved.from_video(FrameOrigin("frames", ImageFiles(tuple(map(str, images[:3])), 1000)))
    with pytest.raises(InputError, match="needs the frames in nerfstudio; got masks alone"):
        export(saved, choose_sets(["nerfstudio"]), tmp_path)


def test_a_file_that_moseg_did_not_write_is_kept(saved, tmp_path):
    mine = tmp_path / "for-colmap" / "images" / "a2.png"
    mine.parent.mkdir(parents=True)
    mine.write_bytes(b"precious")
    with pytest.raises(InputError, match="not known as moseg's own"):
        export(saved, choose_sets(["colmap"]), tmp_path)
    assert mine.read_bytes() == b"precious"
    assert [path.name for path in mine.parent.iterdir()] == ["a2.png"]


@pytest.mark.parametrize("orientation", range(2, 9))
def test_a_photograph_of_any_orientation_is_written_upright(write_saved, tmp_path, orientation):
    upright = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
    upright[:8, :12] = 255
    stored = Image.fromarray(upright.transpose(1, 0, 2) if orientation > 4 else upright)
    exif = stored.getexif()
    exif[0x0112] = orientation
    content = io.BytesIO()
    stored.save(content, "JPEG", exif=exif, quality=95)
    path = tmp_path / "frames" / "a.jpg"
    path.parent.mkdir()
    path.write_bytes(content.getvalue())
    expected = np.asarray(ImageOps.exif_transpose(Image.open(path)).convert("L")).astype(int)
    origin = FrameOrigin(str(path.parent), ImageFiles((str(path),), 1000))
    saved = write_saved(np.zeros((1, HEIGHT, WIDTH), np.uint16), ("a.jpg",)).from_video(origin)
    (folder,) = export(saved, choose_sets(["colmap"]), tmp_path)
    with Image.open(folder / "images" / "a.jpg") as image:
        assert image.getexif().get(0x0112, 1) == 1
        assert np.abs(np.asarray(image.convert("L")).astype(int) - expected).mean() < 3


@pytest.mark.parametrize("orientation", [3, 6, 8])
@pytest.mark.parametrize("suffix", ["jpg", "png", "webp", "tif"])
def test_a_photograph_that_is_turned_keeps_its_exif_data_and_profile(write_saved, tmp_path, orientation, suffix):
    size = (WIDTH, HEIGHT)
    stored = Image.new("RGB", size[::-1] if orientation > 4 else size, (90, 120, 60))
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    exif = Image.Exif()
    exif[0x0112], exif[0x0110] = orientation, "Camera"
    exif.get_ifd(0x8769).update({0xA002: stored.width, 0xA003: stored.height, 0x920A: 4.5, 0xA405: 28})
    exif.get_ifd(0x8825).update({1: "N", 2: (46.0, 31.0, 12.0)})
    path = tmp_path / "frames" / f"a.{suffix}"
    path.parent.mkdir()
    stored.save(path, exif=exif.tobytes(), icc_profile=profile)
    origin = FrameOrigin(str(path.parent), ImageFiles((str(path),), 1000))
    saved = write_saved(np.zeros((1, HEIGHT, WIDTH), np.uint16), (path.name,)).from_video(origin)
    (folder,) = export(saved, choose_sets(["colmap"]), tmp_path)
    with Image.open(folder / "images" / path.name) as image:
        found = image.getexif()
        part = found.get_ifd(0x8769)
        assert image.size == size and image.info["icc_profile"] == profile
        assert found.get(0x0112, 1) == 1 and found[0x0110] == "Camera"
        assert (part[0xA002], part[0xA003], float(part[0x920A]), part[0xA405]) == (*size, 4.5, 28)
        assert found.get_ifd(0x8825)[1] == "N"
        assert np.abs(np.asarray(image, int) - (90, 120, 60)).max() < 6
