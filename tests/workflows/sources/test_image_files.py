import struct

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources import ImageFiles


def read_one(path, max_side=1000):
    return next(ImageFiles((str(path),), max_side).read())


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".tif", ".tiff"])
def test_lossless_images_are_read_as_rgb(tmp_path, picture, write_image, suffix):
    np.testing.assert_array_equal(read_one(write_image(tmp_path / f"a{suffix}", picture)), picture)


@pytest.mark.parametrize("suffix", [".jpg", ".jpeg", ".webp", ".JPG"])
def test_lossy_images_are_read_nearly_as_written(tmp_path, picture, write_image, suffix):
    image = read_one(write_image(tmp_path / f"a{suffix}", picture))
    assert image.dtype == np.uint8
    assert np.abs(image.astype(int) - picture).mean() < 4


def test_grey_becomes_three_equal_channels(tmp_path, picture, write_image):
    grey = picture[..., 0]
    image = read_one(write_image(tmp_path / "a.png", grey))
    np.testing.assert_array_equal(image, np.repeat(grey[..., None], 3, axis=2))


def test_sixteen_bits_scale_to_eight(tmp_path, picture, write_image):
    np.testing.assert_array_equal(read_one(write_image(tmp_path / "a.png", picture.astype(np.uint16) * 257)), picture)
    grey = np.array([[0, 128, 32768, 65535]], np.uint16)
    assert read_one(write_image(tmp_path / "b.png", grey))[0, :, 0].tolist() == [0, 0, 128, 255]


@pytest.mark.parametrize("suffix", [".png", ".tif"])
@pytest.mark.parametrize("mode", ["RGBA", "LA"])
def test_alpha_is_dropped(tmp_path, picture, mode, suffix):
    image = Image.fromarray(picture)
    expected = np.asarray(image.convert(mode[:-1]).convert("RGB"))
    image = image.convert(mode)
    image.putalpha(7)
    image.save(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(read_one(tmp_path / f"a{suffix}"), expected)


@pytest.mark.parametrize("compression", ["raw", "tiff_lzw", "tiff_adobe_deflate"])
@pytest.mark.parametrize("orientation", [1, 2, 3, 5, 6, 8])
def test_alpha_of_a_tiff_changes_nothing_else(tmp_path, picture, compression, orientation):
    opaque = Image.fromarray(picture)
    clear = opaque.convert("RGBA")
    clear.putalpha(0)
    for name, image in (("opaque", opaque), ("clear", clear)):
        image.save(tmp_path / f"{name}.tif", compression=compression, tiffinfo={0x0112: orientation})
    np.testing.assert_array_equal(read_one(tmp_path / "clear.tif"), read_one(tmp_path / "opaque.tif"))


@pytest.mark.parametrize(
    ("orientation", "turned"),
    [(1, lambda a: a), (2, np.fliplr), (3, lambda a: np.rot90(a, 2)), (6, lambda a: np.rot90(a, -1)), (8, np.rot90)],
)
def test_exif_orientation_is_applied(tmp_path, picture, orientation, turned):
    exif = Image.Exif()
    exif[0x0112] = orientation
    Image.fromarray(picture).save(tmp_path / "a.jpg", quality=98, exif=exif)
    image = read_one(tmp_path / "a.jpg").astype(int)
    assert image.shape == turned(picture).shape
    assert np.abs(image - turned(picture)).mean() < 3
    assert ImageFiles((str(tmp_path / "a.jpg"),), 10).describe().size == turned(picture).shape[:2]


def test_names_with_blanks_and_other_scripts_work(tmp_path, picture, write_image):
    np.testing.assert_array_equal(read_one(write_image(tmp_path / "vidéo 映像" / "кадр 1.png", picture)), picture)


def test_longer_side_is_limited_by_area_means(tmp_path, write_image):
    image = np.zeros((40, 80, 3), np.uint8)
    image[::2] = 200
    path = write_image(tmp_path / "a.png", image)
    reduced = read_one(path, max_side=40)
    assert reduced.shape == (20, 40, 3)
    assert (reduced == 100).all()
    assert ImageFiles((path,), 40).describe() == ((40, 80), None)
    assert read_one(path, max_side=80).shape == (40, 80, 3)


def test_a_frame_of_another_size_is_named(tmp_path, picture, write_image):
    paths = (write_image(tmp_path / "0.png", picture), write_image(tmp_path / "1.png", picture[:-1]))
    with pytest.raises(InputError, match=r"1\.png; got 64x47 px; expected 64x48 px"):
        list(ImageFiles(paths, 100).read())


def test_a_frame_of_another_size_is_found_across_chunks(tmp_path, picture, write_image):
    paths = (write_image(tmp_path / "0.png", picture), write_image(tmp_path / "1.png", picture[:-1]))
    chunks = ImageFiles(paths, 100).chunks(1)
    assert len(list(chunks[0].read())) == 1
    with pytest.raises(InputError, match=r"1\.png"):
        list(chunks[1].read())


def test_chunks_are_the_whole_in_order(tmp_path, picture, write_image):
    paths = tuple(write_image(tmp_path / f"{i}.png", np.roll(picture, i, 1)) for i in range(5))
    whole = ImageFiles(paths, 32)
    assert whole.num_frames() == 5
    chunks = whole.chunks(2)
    assert [len(chunk.paths) for chunk in chunks] == [2, 2, 1]
    np.testing.assert_array_equal([image for chunk in chunks for image in chunk.read()], list(whole.read()))


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".bmp"])
@pytest.mark.parametrize("kept", [0.0, 0.5, 0.95])
def test_a_truncated_image_is_named(tmp_path, picture, write_image, suffix, kept):
    path = tmp_path / f"a{suffix}"
    write_image(path, picture)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    with pytest.raises(InputError, match=f"decoded in .*a{suffix}"):
        read_one(path)


def _padded(content: bytes, marker: bytes, padding: bytes) -> bytes:
    place = content.rindex(marker)
    return content[:place] + padding + content[place:]


END, START_OF_SCAN = b"\xff\xd9", b"\xff\xda"


@pytest.mark.parametrize(("marker", "padding"), [(END, b"\x01\x02"), (END, bytes(9)), (START_OF_SCAN, bytes(4))])
def test_a_padded_jpeg_is_the_same_picture(tmp_path, picture, write_image, capfd, marker, padding):
    path = tmp_path / "a.jpg"
    write_image(path, picture)
    expected = read_one(path)
    path.write_bytes(_padded(path.read_bytes(), marker, padding))
    np.testing.assert_array_equal(read_one(path), expected)
    assert capfd.readouterr().err == ""


def test_a_padded_jpeg_that_is_damaged_after_the_padding_is_named(tmp_path, picture, write_image):
    path = tmp_path / "a.jpg"
    write_image(path, picture)
    content = _padded(path.read_bytes(), START_OF_SCAN, bytes(4))
    path.write_bytes(content[:-40] + END)
    with pytest.raises(InputError, match=r"image is damaged in .*a\.jpg; got Corrupt JPEG data: premature end"):
        read_one(path)


@pytest.mark.parametrize(("marker", "padding"), [(END, bytes(40)), (START_OF_SCAN, b"\x01\x02")])
def test_misplaced_data_are_damage(tmp_path, picture, write_image, marker, padding):
    path = tmp_path / "a.jpg"
    write_image(path, picture)
    path.write_bytes(_padded(path.read_bytes(), marker, padding))
    with pytest.raises(InputError, match="extraneous bytes"):
        read_one(path)


def test_float_images_are_refused(tmp_path, write_image):
    path = write_image(tmp_path / "a.tif", np.zeros((4, 4, 3), np.float32))
    with pytest.raises(InputError, match="float32; expected 8- or 16-bit"):
        read_one(path)


def test_images_of_long_integers_are_refused(tmp_path):
    Image.fromarray(np.zeros((4, 4), np.int32)).save(tmp_path / "a.tif")
    with pytest.raises(InputError, match="int32; expected 8- or 16-bit"):
        read_one(tmp_path / "a.tif")


def test_a_file_that_has_gone_is_named(tmp_path):
    with pytest.raises(MissingInputError, match=r"gone\.png"):
        read_one(tmp_path / "gone.png")


def test_an_empty_list_of_images_is_refused():
    with pytest.raises(InputError, match="no frames"):
        ImageFiles((), 100)


def test_a_tiff_with_an_empty_second_page_is_read(tmp_path, picture):
    path = tmp_path / "a.tif"
    Image.fromarray(picture).save(path)
    content = path.read_bytes()
    (start,) = struct.unpack_from("<I", content, 4)
    next_page = start + 2 + 12 * content[start]
    second = struct.pack("<HI", 0, 0)
    path.write_bytes(content[:next_page] + struct.pack("<I", len(content)) + content[next_page + 4 :] + second)
    np.testing.assert_array_equal(read_one(path), picture)
