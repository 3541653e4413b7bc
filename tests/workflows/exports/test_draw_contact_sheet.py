"""A sheet has one column a frame and one row for each of their pictures."""

import cv2
import numpy as np
import pytest

from moseg.workflows.exports.colour_maps import colour_soft_map
from moseg.workflows.exports.draw_contact_sheet import (
    TILE_SIDE,
    SheetFrame,
    draw_column,
    draw_contact_sheet,
    tile_shape,
)
from moseg.workflows.exports.draw_errors import draw_errors
from moseg.workflows.exports.draw_overlay import draw_labels

SHAPE = (TILE_SIDE // 2, TILE_SIDE)


def made_up(index=0, shape=SHAPE, **without):
    """A frame of the tile's size with two objects, one of them found, and a soft map."""
    rng = np.random.default_rng(index)
    labels, truth = np.zeros(shape, np.uint16), np.zeros(shape, np.uint8)
    labels[4:20, 5 : 25 + index] = 3
    truth[4:20, 5:25] = 1
    truth[30:40, 5:25] = 2
    image = rng.integers(0, 256, (*shape, 3), dtype=np.uint8)
    return SheetFrame(index, image, labels, rng.random(shape, dtype=np.float32), truth, 40.0)._replace(**without)


def corner(sheet, tile):
    """Where in a sheet a tile lies, as (y, x)."""
    height, width = tile.shape[:2]
    found = np.argwhere((sheet[: 1 - height or None, : 1 - width or None] == tile[0, 0]).all(axis=-1))
    places = [(y, x) for y, x in found if np.array_equal(sheet[y : y + height, x : x + width], tile)]
    (place,) = places
    return place


def test_rows_are_frame_soft_map_mask_and_errors_from_top_to_bottom():
    frame = made_up()
    sheet = draw_contact_sheet("a line", [frame], void=2)
    pictures = (
        frame.image,
        colour_soft_map(frame.soft_map),
        draw_labels(frame.image, frame.labels),
        draw_errors(frame.image, frame.labels, frame.truth, 2),
    )
    corners = [corner(sheet, picture) for picture in pictures]
    rows, columns = zip(*corners, strict=True)
    assert list(rows) == sorted(rows)
    assert np.diff(rows).min() > SHAPE[0]
    assert len(set(columns)) == 1


@pytest.mark.parametrize(
    ("without", "titles"),
    [
        ({}, ["frame", "posterior", "mask", "errors"]),
        ({"soft_map": None}, ["frame", "mask", "errors"]),
        ({"truth": None, "J": None}, ["frame", "posterior", "mask"]),
        ({"soft_map": None, "truth": None, "J": None}, ["frame", "mask"]),
    ],
)
def test_pictures_that_frames_lack_have_no_row(without, titles):
    assert list(draw_column(made_up(**without), "posterior")) == titles
    heights = [draw_contact_sheet("", [frame]).shape[0] for frame in (made_up(), made_up(**without))]
    assert heights[0] - heights[1] == (4 - len(titles)) * (SHAPE[0] + 6)


def test_frames_stand_side_by_side_in_their_order():
    frames = [made_up(index) for index in range(3)]
    sheet = draw_contact_sheet("", iter(frames))
    rows, columns = zip(*(corner(sheet, frame.image) for frame in frames), strict=True)
    assert len(set(rows)) == 1
    assert list(columns) == sorted(columns)


def test_captions_name_frame_and_similarity():
    assert made_up(7).caption == "frame 7   J 40.0"
    assert made_up(7, J=None).caption == "frame 7"


def test_the_head_the_captions_and_the_titles_are_written():
    sheet = draw_contact_sheet("", [made_up(J=None)])
    assert not np.array_equal(draw_contact_sheet("dog", [made_up(J=None)]), sheet)
    assert not np.array_equal(draw_contact_sheet("", [made_up()]), sheet)
    assert not np.array_equal(draw_contact_sheet("", [made_up(J=None)], "posterior"), sheet)


def test_a_long_head_line_widens_the_sheet():
    short, long = (draw_contact_sheet("w" * length, [made_up()]) for length in (3, 200))
    assert long.shape[0] == short.shape[0]
    blank = (long[:, -16:] == 255).all()
    assert blank and long.shape[1] > short.shape[1]


@pytest.mark.parametrize("shape", [(480, 854), (854, 480), (48, 64), (2, 300), (300, 2), (320, 320)])
def test_frames_of_any_size_and_form_get_tiles_of_one_size(shape):
    frame = made_up(shape=shape, truth=np.zeros((30, 40), np.uint8), soft_map=np.zeros((9, 16), np.float32))
    tiles = draw_column(frame, "saliency")
    assert {tile.shape for tile in tiles.values()} == {(*tile_shape(shape), 3)}
    assert max(tile_shape(shape)) == TILE_SIDE
    draw_contact_sheet("", [frame, frame])


def test_objects_and_errors_keep_their_place_when_the_frame_is_reduced():
    shape = (4 * SHAPE[0], 4 * SHAPE[1])
    small = made_up()
    labels = cv2.resize(small.labels, shape[::-1], interpolation=cv2.INTER_NEAREST)
    image = cv2.resize(small.image, shape[::-1], interpolation=cv2.INTER_NEAREST)
    tiles, expected = draw_column(small._replace(image=image, labels=labels), "s"), draw_column(small, "s")
    np.testing.assert_array_equal(tiles["mask"], expected["mask"])
    np.testing.assert_allclose(tiles["errors"].astype(int), expected["errors"], atol=1)


def test_soft_maps_are_dark_at_zero_and_bright_at_one_in_every_frame():
    levels = colour_soft_map(np.linspace(-0.5, 1.5, 41, dtype=np.float32)[None])[0].astype(int)
    assert levels[0].max() < 10
    assert levels[-1].min() > 100
    np.testing.assert_array_equal(levels[0], levels[10])
    np.testing.assert_array_equal(levels[30], levels[-1])
    # Luma of Rec. 601.
    lightness = levels @ [0.299, 0.587, 0.114]
    assert (np.diff(lightness[10:31]) > 0).all()
