import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.sources import MaskFiles
from moseg.workflows.sources.mask_files import find_mask_kind

IDS = np.array([[0, 1, 2], [7, 254, 255]], np.uint8)


def save(path, image, **options):
    image.save(path, **options)
    return str(path)


def palette(ids):
    image = Image.fromarray(ids).convert("P")
    image.putdata(ids.ravel().tolist())
    # Two indices share a colour and index 2 is black: colours would lose both.
    image.putpalette([0, 0, 0, 128, 0, 0, 0, 0, 0] + [128, 0, 0] * 253)
    return image


def read_one(path, kind="instance", size=None):
    index, labels = next(MaskFiles(((4, str(path)),), kind, size).read())
    assert index == 4
    assert labels.dtype == np.uint16
    return labels


def test_palette_gives_indices_not_colours(tmp_path):
    np.testing.assert_array_equal(read_one(save(tmp_path / "a.png", palette(IDS))), IDS)
    np.testing.assert_array_equal(read_one(save(tmp_path / "b.png", palette(IDS), transparency=2)), IDS)


@pytest.mark.parametrize("bits", [1, 2, 4])
def test_small_palettes_give_indices(tmp_path, bits):
    ids = np.arange(2**bits, dtype=np.uint8)[None]
    np.testing.assert_array_equal(read_one(save(tmp_path / "a.png", palette(ids), bits=bits)), ids)


def test_grey_and_grey_saved_as_colour_give_ids(tmp_path):
    grey = Image.fromarray(IDS)
    for mode in ("L", "LA", "RGB", "RGBA"):
        np.testing.assert_array_equal(read_one(save(tmp_path / f"{mode}.png", grey.convert(mode))), IDS)


def test_sixteen_bit_ids_are_kept(tmp_path):
    ids = np.array([[0, 255, 256, 65535]], np.uint16)
    np.testing.assert_array_equal(read_one(save(tmp_path / "a.png", Image.fromarray(ids))), ids)


def test_binary_counts_any_value_or_colour(tmp_path):
    expected = (IDS > 0).astype(np.uint16)
    np.testing.assert_array_equal(read_one(save(tmp_path / "a.png", Image.fromarray(IDS)), "binary"), expected)
    np.testing.assert_array_equal(read_one(save(tmp_path / "b.png", palette(IDS)), "binary"), expected)
    colours = np.zeros((2, 3, 3), np.uint8)
    colours[0, 1, 2] = colours[1, 2, 0] = 9
    opaque = Image.fromarray(colours).convert("RGBA")
    labels = read_one(save(tmp_path / "c.png", opaque), "binary")
    np.testing.assert_array_equal(labels, [[0, 1, 0], [0, 0, 1]])
    bits = Image.fromarray(IDS > 0)
    np.testing.assert_array_equal(read_one(save(tmp_path / "d.png", bits), "binary"), expected)


def test_colours_are_refused_as_ids(tmp_path):
    colours = np.zeros((2, 3, 3), np.uint8)
    colours[0, 0, 0] = 255
    path = save(tmp_path / "a.png", Image.fromarray(colours))
    with pytest.raises(InputError, match=r"colours in .*a\.png"):
        read_one(path)


def test_a_mask_of_the_wrong_size_is_named(tmp_path):
    path = save(tmp_path / "a.png", Image.fromarray(IDS))
    with pytest.raises(InputError, match=r"a\.png; got 3x2 px; expected 5x2 px"):
        read_one(path, size=(2, 5))


@pytest.mark.parametrize("kept", [0.0, 0.3, 0.8])
def test_a_broken_mask_is_named(tmp_path, kept):
    path = tmp_path / "a.png"
    Image.fromarray(np.random.default_rng(0).integers(0, 9, (30, 30)).astype(np.uint8)).save(path)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    with pytest.raises(InputError, match=r"decoded in .*a\.png"):
        read_one(path)


def test_masks_are_read_with_their_frames(tmp_path):
    items = tuple((index, save(tmp_path / f"{index}.png", Image.fromarray(IDS + index))) for index in (0, 5, 10))
    read = list(MaskFiles(items, "instance").read())
    assert [index for index, _ in read] == [0, 5, 10]
    np.testing.assert_array_equal(read[1][1], IDS + 5)


def test_an_empty_list_of_masks_is_refused():
    with pytest.raises(InputError, match="no masks"):
        MaskFiles((), "binary")


@pytest.mark.parametrize(
    ("ids", "kind"), [([[0, 255]], "binary"), ([[0, 0]], "binary"), ([[0, 1]], "instance"), ([[1, 255]], "instance")]
)
def test_masks_of_0_and_255_alone_are_binary(tmp_path, ids, kind):
    paths = (
        save(tmp_path / "0.png", Image.fromarray(np.zeros((1, 2), np.uint8))),
        save(tmp_path / "1.png", Image.fromarray(np.array(ids, np.uint8))),
    )
    assert find_mask_kind(paths) == kind
