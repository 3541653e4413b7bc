"""Masks of what may be static: which tracks are labelled, and how far their labels reach."""

import numpy as np
import pytest

from moseg.schemas.parameters import TrackSurfaceParams
from moseg.tasks.proposals.surface_masks import static_candidates, surface_masks

SHAPE = (60, 101)
PARAMS = TrackSurfaceParams(mask_radius=8.0)


def _masks(points, labels, visible=None, frames=None, shape=SHAPE):
    points = np.array(points, np.float32)
    if points.ndim == 2:
        points = points[:, None]
    visible = np.ones(points.shape[:2], bool) if visible is None else np.array(visible)
    frames = range(points.shape[1]) if frames is None else frames
    return surface_masks(shape, points, visible, np.array(labels, np.uint16), frames, PARAMS)


def test_surfaces_are_numbered_after_all_objects_and_moving_objects_are_left_out():
    objects, surface = np.array([1, 2, 0, 0, 0, 2], np.uint16), np.array([0, 0, 1, 3, 0, 3], np.uint16)
    labels = static_candidates(objects, np.array([True, False, True]), surface, 16)
    assert labels.dtype == np.uint16
    # A track of an object is that object's, not its surface's.
    assert labels.tolist() == [0, 2, 4, 6, 0, 2]
    assert static_candidates(objects, np.array([True, True, True]), surface, 16).tolist() == [0, 0, 4, 6, 0, 0]


@pytest.mark.parametrize(("num_surfaces", "expected"), [(0, [0, 0, 0]), (1, [2, 0, 0]), (2, [2, 3, 0]), (9, [2, 3, 4])])
def test_no_more_surfaces_than_are_asked_for(num_surfaces, expected):
    surface = np.array([1, 2, 3], np.uint16)
    assert static_candidates(np.zeros(3, np.uint16), np.array([True]), surface, num_surfaces).tolist() == expected


def test_surfaces_for_which_there_is_no_number_are_left_out():
    surface = np.array([1, 65534, 65535], np.uint16)
    for is_moving, expected in (([False], [2, 65535, 0]), ([False, True], [3, 0, 0])):
        labels = static_candidates(np.zeros(3, np.uint16), np.array(is_moving), surface, 10**6)
        assert labels.tolist() == expected


def test_without_objects_surfaces_are_numbered_from_one_and_without_tracks_nothing_is():
    none = np.zeros(0, bool)
    assert static_candidates(np.zeros(2, np.uint16), none, np.array([2, 0], np.uint16), 16).tolist() == [2, 0]
    assert static_candidates(np.zeros(0, np.uint16), none, np.zeros(0, np.uint16), 16).tolist() == []


def test_a_pixel_takes_the_label_of_its_nearest_track_within_the_radius():
    masks = _masks([[30, 30], [42, 30], [80, 30]], [7, 0, 40000])
    assert (masks.shape, masks.dtype) == ((1, *SHAPE), np.uint16)
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    distance = np.stack([np.hypot(x - column, y - 30) for column in (30, 42, 80)])
    nearest = np.array([7, 0, 40000])[distance.argmin(axis=0)]
    truth = np.where(distance.min(axis=0) <= PARAMS.mask_radius, nearest, 0)
    # But for the grid of every second pixel.
    unclear = (np.abs(distance.min(axis=0) - PARAMS.mask_radius) < 3) | (np.abs(distance[0] - distance[1]) < 4)
    np.testing.assert_array_equal(masks[0][~unclear], truth[~unclear])
    assert {*np.unique(masks)} == {0, 7, 40000}
    # The track in between keeps the surface off.
    assert np.count_nonzero(masks == 7) < np.count_nonzero(masks == 40000)


def test_a_label_goes_where_its_track_does_in_the_frames_asked_for():
    columns = np.array([10, 30, 50, 70])
    points = np.stack([columns, np.full(4, 20)], axis=1)[None]
    masks = _masks(points, [1], frames=range(1, 4))
    assert [mask[20, column] for mask, column in zip(masks, columns[1:], strict=True)] == [1, 1, 1]
    assert not masks[:, :, :15].any()


def test_hidden_tracks_have_no_pixels_and_are_not_read():
    points = np.full((2, 3, 2), 30.0)
    points[1] = 50
    visible = np.array([[True, False, True], [True, True, False]])
    points[~visible] = np.nan
    masks = _masks(points, [3, 0], visible)
    assert [mask.any() for mask in masks] == [True, False, True]


@pytest.mark.parametrize("num_tracks", [0, 1])
def test_frames_in_which_nothing_is_seen_are_empty(num_tracks):
    points = np.zeros((num_tracks, 2, 2), np.float32)
    masks = _masks(points, [1] * num_tracks, np.zeros((num_tracks, 2), bool))
    assert masks.shape == (2, *SHAPE)
    assert not masks.any()


@pytest.mark.parametrize("place", [(0, 0), (100, 59), (100.4, 59.4)])
def test_tracks_in_the_corners_of_the_frame(place):
    mask = _masks([place], [5])[0]
    assert mask[min(round(place[1]), 59), min(round(place[0]), 100)] == 5
