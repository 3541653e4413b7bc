"""Folders of frames: what lies in them, how they are named, and images that are unusual or damaged."""

import os
import shutil
import struct
import zlib

import cv2
import numpy as np
import pytest
from PIL import Image

from moseg.workflows.sources import open_frames
from moseg.workflows.sources.image_files import decode_image


def _as(mode, **options):
    """Saves an RGB array by Pillow in another mode."""
    return lambda image, path: Image.fromarray(image).convert(mode).save(path, **options)


def _sixteen_bits(image, path):
    cv2.imwrite(str(path), image[..., ::-1].astype(np.uint16) * 257)


def _sixteen_bit_grey(image, path):
    cv2.imwrite(str(path), image[..., 1].astype(np.uint16) * 257)


def _sixteen_bit_alpha(image, path):
    alpha = np.full(image.shape[:2], 9_000, np.uint16)
    cv2.imwrite(str(path), np.dstack([image[..., ::-1].astype(np.uint16) * 257, alpha]))


def _alpha(image, path):
    with_alpha = Image.fromarray(image).convert("RGBA")
    with_alpha.putalpha(9)
    with_alpha.save(path)


def _green(image):
    return np.repeat(image[..., 1:2], 3, axis=2)


def _grey(image):
    return np.repeat(np.asarray(Image.fromarray(image).convert("L"))[..., None], 3, axis=2)


def _itself(image):
    return image


def _palette(image):
    return np.asarray(Image.fromarray(image).convert("P").convert("RGB"))


def _bits(image):
    return np.asarray(Image.fromarray(image).convert("1").convert("RGB"))


EXACT = {
    "grey png": (_as("L"), ".png", _grey),
    "grey and alpha png": (_as("LA"), ".png", _grey),
    "palette png": (_as("P"), ".png", _palette),
    "1-bit png": (_as("1"), ".png", _bits),
    "alpha png": (_alpha, ".png", _itself),
    "16-bit png": (_sixteen_bits, ".png", _itself),
    "16-bit grey png": (_sixteen_bit_grey, ".png", _green),
    "16-bit alpha png": (_sixteen_bit_alpha, ".png", _itself),
    "16-bit tiff": (_sixteen_bits, ".tif", _itself),
    "16-bit grey tiff": (_sixteen_bit_grey, ".tif", _green),
    "16-bit alpha tiff": (_sixteen_bit_alpha, ".tiff", _itself),
    "compressed tiff": (_as("RGB", compression="tiff_lzw"), ".tif", _itself),
    "lossless webp": (_as("RGB", lossless=True), ".webp", _itself),
    "bmp": (_as("RGB"), ".bmp", _itself),
}
NEARLY = {
    "CMYK jpeg": (_as("CMYK", quality=98), ".jpg", _itself),
    "grey jpeg": (_as("L", quality=98), ".jpg", _grey),
    "progressive jpeg": (_as("RGB", quality=98, subsampling=0, progressive=True), ".jpeg", _itself),
}


@pytest.mark.parametrize("kind", [*EXACT, *NEARLY])
def test_unusual_images_become_the_frames_they_show(masks_of, write_folder, frames, kind):
    save, suffix, shown = (EXACT | NEARLY)[kind]
    folder = write_folder(save=save, suffix=suffix)
    found = np.stack(list(open_frames(str(folder), 1000).read())).astype(int)
    expected = np.stack([shown(image) for image in frames])
    assert np.abs(found - expected).max() <= (0 if kind in EXACT else 40)
    assert np.abs(found - expected).mean() <= (0 if kind in EXACT else 3)
    assert masks_of(folder).shape == (5, 48, 64)


def test_every_step_of_16_bits_is_scaled_and_none_wraps(tmp_path):
    values = np.arange(2**16, dtype=np.uint16).reshape(256, 256)
    cv2.imwrite(str(tmp_path / "a.png"), values)
    found = decode_image((tmp_path / "a.png").read_bytes(), "a.png")[..., 0]
    assert np.abs(found - values * (255 / 65535)).max() <= 0.5 + 1e-9


def test_photos_that_a_camera_turned_are_upright(masks_of, write_folder):
    exif = Image.Exif()
    exif[0x0112] = 6
    assert masks_of(write_folder(save=_as("RGB", exif=exif), suffix=".jpg")).shape == (5, 64, 48)


@pytest.mark.parametrize("suffix", [".png", ".webp", ".tif"])
def test_an_image_of_several_frames_is_refused(refuse, write_folder, suffix):
    def save(image, path):
        Image.fromarray(image).save(path, save_all=True, append_images=[Image.fromarray(image[::-1])])

    folder = write_folder(save=save, suffix=suffix)
    refuse(folder, "several frames in one image", folder / f"00000{suffix}", "got 2")


def test_samples_without_a_range_are_refused(refuse, write_folder):
    def save(image, path):
        cv2.imwrite(str(path), image.astype(np.float32))

    folder = write_folder(save=save, suffix=".tif")
    refuse(folder, "unusable samples", folder / "00000.tif", "got float32", "8- or 16-bit integers")


def test_frames_of_different_sizes_name_the_first_odd_one(refuse, write_folder, frames):
    folder = write_folder(images=[*frames[:3], frames[3][:40], frames[4]])
    refuse(folder, folder / "00003.png", "got 64x40 px", "expected 64x48 px as the first")


def _damages(content):
    middle = len(content) // 2
    return {
        "empty": b"",
        "text": b"404 not found\n",
        "cut": content[:middle],
        "end lost": content[:-4],
        "zeros within": content[:middle] + bytes(60) + content[middle + 60 :],
        "early end": content[:middle] + b"\xff\xd9" + content[middle + 2 :],
    }


@pytest.mark.parametrize("damage", _damages(b"").keys())
@pytest.mark.parametrize("suffix", [".jpg", ".png"])
def test_one_damaged_image_among_good_ones_is_named(refuse, write_folder, suffix, damage):
    folder = write_folder(suffix=suffix)
    path = folder / f"00003{suffix}"
    path.write_bytes(_damages(path.read_bytes())[damage])
    refuse(folder, f" in {path}; got ")


def test_a_damaged_tiff_says_so_in_one_line(refuse, write_folder):
    folder = write_folder(suffix=".tif")
    path = folder / "00002.tif"
    path.write_bytes(path.read_bytes()[:3000])
    refuse(folder, "image cannot be decoded", path)


def _flat_png(width, height):
    """A PNG of nothing but black, which takes next to no bytes."""

    def chunk(kind, content):
        check = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", check)

    squeeze = zlib.compressobj(9)
    rows = b"".join(squeeze.compress(bytes(1 + width // 8)) for _ in range(height)) + squeeze.flush()
    header = struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


@pytest.mark.parametrize("side", [12_000, 16_000])
def test_an_image_that_unfolds_to_too_many_pixels_is_refused_unread(refuse, write_folder, side):
    folder = write_folder()
    (folder / "00002.png").write_bytes(_flat_png(side, side))
    refuse(folder, "too many pixels", folder / "00002.png", "at most 134217728 px")


def test_an_image_that_cannot_be_opened_is_named(refuse, write_folder):
    folder = write_folder()
    path = folder / "00002.png"
    path.unlink()
    path.mkdir()
    refuse(folder, "cannot be read", path, "Is a directory")
    path.rmdir()
    path.symlink_to(folder / "gone")
    refuse(folder, "does not exist", path)


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every file")
def test_a_file_without_permission_is_named(refuse, write_folder, write_video):
    folder = write_folder()
    (folder / "00002.png").chmod(0)
    refuse(folder, "Permission denied", folder / "00002.png")
    path = write_video()
    path.chmod(0)
    refuse(path, "Permission denied", path)


@pytest.mark.parametrize("content", ["nothing", "notes", "folders", "hidden"])
def test_a_folder_without_images_says_what_it_should_hold(refuse, tmp_path, write_folder, content):
    folder = tmp_path / "clip"
    folder.mkdir()
    if content == "notes":
        (folder / "notes.txt").write_text("no image")
    elif content == "folders":
        write_folder("clip/takes/1")
    elif content == "hidden":
        (folder / "._00000.png").write_bytes(b"")
    refuse(folder, f"no images in {folder}", ".png .jpg")


def test_other_files_beside_the_frames_are_left_out(masks_of, write_folder):
    folder = write_folder()
    for name in ("Thumbs.db", ".DS_Store", "._00000.png", "desktop.ini", "frames.csv", "00000.xmp"):
        (folder / name).write_bytes(b"\x00\x05\x16\x07 none of our business")
    (folder / "thumbnails").mkdir()
    assert len(masks_of(folder)) == 5


def test_frames_are_taken_in_the_order_of_their_numbers(masks_of, write_folder, frames, tmp_path):
    numbers = (1, 2, 9, 10, 11)
    folder = write_folder(images=frames)
    for number, path in zip(numbers, sorted(folder.iterdir()), strict=True):
        path.rename(folder / f"frame{number}.png")
    assert [os.path.basename(path) for path in open_frames(str(folder), 99).paths] == [f"frame{n}.png" for n in numbers]
    np.testing.assert_array_equal(masks_of(folder), masks_of(write_folder("padded")))


def test_images_of_several_kinds_are_one_sequence(masks_of, write_folder, frames):
    folder = write_folder(images=frames[:3])
    Image.fromarray(frames[3]).save(folder / "00003.BMP")
    Image.fromarray(frames[4]).save(folder / "00004.TIF")
    assert len(masks_of(folder)) == 5


def test_two_images_of_one_number_are_refused(refuse, write_folder, frames):
    folder = write_folder()
    Image.fromarray(frames[2]).save(folder / "00002.bmp")
    refuse(folder, "two files of one stem", "00002.bmp and 00002.png")


NAMES = {
    "blanks": "my holiday film",
    "other scripts": "фильм 映像 ölçü",
    "numbers of FFmpeg": "take %03d %d",
    "wildcards": "take [1]?*",
    "a leading dash": "-take",
    "a line break": "take\n1",
    "quotes": 'it\'s "here" $HOME; `ls`',
    "a protocol": "http: take",
    "a long name": "t" * 250,
}


@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize("is_folder", [True, False])
def test_any_name_that_the_system_takes_is_taken(
    segment, write_folder, write_video, tmp_path, monkeypatch, kind, is_folder
):
    source = write_folder(NAMES[kind]) if is_folder else write_video().rename(tmp_path / NAMES[kind])
    monkeypatch.chdir(tmp_path)
    out = tmp_path / f"{NAMES[kind][:200]} out"
    ran = segment(source.name, out=out)
    assert (ran.code, ran.err) == (0, "")
    assert len(list((out / "masks").iterdir())) == 5
    shutil.rmtree(out)


def test_a_bad_file_with_a_line_break_in_its_name_is_still_one_line(refuse, tmp_path):
    path = tmp_path / "a\nb.mp4"
    path.write_bytes(b"no video")
    refuse(path, "a b.mp4")
