import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import LocalColourParams, RefinementParams
from moseg.tasks.proposals import refine_outlines

PARAMS = RefinementParams(), LocalColourParams()
GRID = (48, 64)


def scene(boxes, scale=4, grid=GRID, certainty=0.95):
    """Frame, labels and foreground of objects, each its own colour, in `boxes` (y0, y1, x0, x1) of the grid."""
    colours = ((200, 60, 60), (60, 180, 60), (60, 60, 200))
    labels, foreground = np.zeros(grid, np.uint16), np.full(grid, 0.05, np.float32)
    frame = np.full((round(grid[0] * scale), round(grid[1] * scale), 3), 128, np.uint8)
    for label, ((y0, y1, x0, x1), colour) in enumerate(zip(boxes, colours, strict=False), start=1):
        labels[y0:y1, x0:x1] = label
        foreground[y0:y1, x0:x1] = certainty
        y0, y1, x0, x1 = (round(scale * each) for each in (y0, y1, x0, x1))
        frame[y0:y1, x0:x1] = colour
    return frame, labels, foreground


def enlarged(labels: np.ndarray, frame: np.ndarray) -> np.ndarray:
    return cv2.resize(labels, frame.shape[1::-1], interpolation=cv2.INTER_NEAREST)


def overlap(mask0: np.ndarray, mask1: np.ndarray) -> float:
    return (mask0 & mask1).sum() / (mask0 | mask1).sum()


def test_an_object_whose_outline_is_an_edge_of_the_frame_keeps_it():
    frame, labels, foreground = scene([(12, 30, 20, 44)])
    objects = refine_outlines(frame, labels, foreground, *PARAMS)
    assert objects.dtype == np.uint16 and objects.shape == frame.shape[:2]
    assert overlap(objects == 1, enlarged(labels, frame) == 1) > 0.98


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("shift", [1, -1])
def test_an_outline_off_by_a_cell_moves_to_the_edge_of_the_frame(shift, axis):
    frame, labels, foreground = scene([(12, 30, 20, 44)])
    truth = enlarged(labels, frame) > 0
    shifted, moved = np.roll(labels, shift, axis), np.roll(foreground, shift, axis)
    before = overlap(enlarged(shifted, frame) > 0, truth)
    assert before < 0.93 and overlap(refine_outlines(frame, shifted, moved, *PARAMS) > 0, truth) > 0.97


def test_an_edge_between_cells_is_found_at_full_size():
    frame, labels, foreground = scene([(12, 30, 20, 44)])
    frame[:, 78:80][48:120] = (200, 60, 60)  # the object reaches half a cell further to the left
    columns = np.flatnonzero(refine_outlines(frame, labels, foreground, *PARAMS)[84])
    assert (columns[0], columns[-1]) == (78, 175)


def test_a_hole_that_was_filled_belongs_to_the_object_at_full_size():
    """Its label says so, whereas its probability to move is below a half, and its colour not that of the object."""
    frame, labels, foreground = scene([(8, 40, 12, 52)])
    hole = np.s_[18:30, 24:40]
    foreground[hole] = 0.3
    frame[72:120, 96:160] = (150, 90, 90)
    assert (refine_outlines(frame, labels, foreground, *PARAMS)[40:152, 56:200] == 1).all()
    labels[hole] = 0
    assert not refine_outlines(frame, labels, foreground, *PARAMS)[84:108, 108:148].any()


def test_two_objects_side_by_side_keep_their_labels():
    frame, labels, foreground = scene([(12, 30, 10, 26), (36, 44, 44, 60), (12, 30, 26, 40)])
    objects = refine_outlines(frame, labels, foreground, *PARAMS)
    assert set(np.unique(objects)) == {0, 1, 2, 3}
    assert not (objects[: 4 * 32] == 2).any()  # no label between 1 and 3 where they meet
    for label in (1, 2, 3):
        assert overlap(objects == label, enlarged(labels, frame) == label) > 0.95


def test_a_component_that_was_not_kept_does_not_bleed_into_its_neighbour():
    frame, labels, foreground = scene([(12, 30, 10, 26), (12, 30, 26, 40)])
    frame[:, 104:160] = frame[60, 60]  # of the object's own colour
    alone = np.where(labels == 1, labels, 0)
    objects = refine_outlines(frame, alone, foreground, *PARAMS)
    assert set(np.unique(objects)) == {0, 1}
    assert objects[4 * 21, 4 * 24] == 1 and not objects[:, 4 * 27 :].any()
    bled = foreground * (labels == 1)
    np.testing.assert_array_equal(objects[:, : 4 * 24], refine_outlines(frame, alone, bled, *PARAMS)[:, : 4 * 24])


def test_likely_background_keeps_its_own_probability():
    frame, labels, foreground = scene([(12, 30, 20, 44)], certainty=0.6)
    frame[:] = 128  # no edges: the outline lies where the smoothed probability crosses a half
    wide = np.where(labels > 0, foreground, np.float32(0.45))
    narrow = np.where(labels > 0, foreground, np.float32(0.0))
    assert (refine_outlines(frame, labels, wide, *PARAMS) > 0).sum() > 1.2 * (
        refine_outlines(frame, labels, narrow, *PARAMS) > 0
    ).sum()


@pytest.mark.parametrize("corner", [(0, 14, 0, 20), (34, 48, 44, 64), (0, 48, 22, 40), (0, 48, 0, 64)])
def test_an_object_at_the_border_of_the_frame_reaches_it(corner):
    frame, labels, foreground = scene([corner])
    objects = refine_outlines(frame, labels, foreground, *PARAMS)
    assert overlap(objects > 0, enlarged(labels, frame) > 0) > 0.97
    assert objects[tuple(each[0] for each in np.nonzero(enlarged(labels, frame)))] == 1


def test_no_objects_are_none_at_full_size():
    frame, labels, foreground = scene([])
    objects = refine_outlines(frame, labels, np.full_like(foreground, 0.9), *PARAMS)
    assert objects.shape == frame.shape[:2] and objects.dtype == np.uint16 and not objects.any()


@pytest.mark.parametrize("scale", [0.5, 1, 1.37, 2.5, 3])
def test_frames_of_any_size_beside_the_grid_have_the_objects_where_they_were(scale):
    frame, labels, foreground = scene([(12, 30, 20, 44)], scale)
    objects = refine_outlines(frame, labels, foreground, *PARAMS)
    assert objects.shape == frame.shape[:2]
    assert overlap(objects == 1, frame[..., 0] == 200) > 0.97


def test_an_object_in_cells_that_the_frame_has_no_pixel_for_is_not_seen():
    labels = np.zeros(GRID, np.uint16)
    labels[-1, -1] = 1
    objects = refine_outlines(np.zeros((1, 1, 3), np.uint8), labels, np.ones(GRID, np.float32), *PARAMS)
    assert objects.tolist() == [[0]]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 15), st.integers(1, 15), st.integers(1, 40), st.integers(1, 40))
def test_any_sizes_give_only_the_labels_there_are(seed, height, width, full_height, full_width):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, 4, (height, width)).astype(np.uint16)
    foreground = rng.random((height, width), np.float32)
    frame = rng.integers(0, 256, (full_height, full_width, 3), np.uint8)
    before = labels.copy(), foreground.copy(), frame.copy()
    objects = refine_outlines(frame, labels, foreground, *PARAMS)
    assert objects.shape == (full_height, full_width) and objects.dtype == np.uint16
    assert set(np.unique(objects)) <= {0, *np.unique(labels).tolist()}
    assert all(np.array_equal(*each) for each in zip(before, (labels, foreground, frame), strict=True))


def test_pixels_far_from_the_objects_are_not_processed():
    frame, labels, foreground = scene([(12, 30, 20, 34)])
    other = frame.copy()
    other[:, 4 * 48 :] = np.random.default_rng(0).integers(0, 256, other[:, 4 * 48 :].shape)
    np.testing.assert_array_equal(
        refine_outlines(frame, labels, foreground, *PARAMS), refine_outlines(other, labels, foreground, *PARAMS)
    )


def test_mirroring_the_frame_mirrors_the_objects():
    frame, labels, foreground = scene([(12, 30, 10, 26), (20, 40, 34, 50)])
    objects = refine_outlines(frame, labels, foreground, *PARAMS)
    mirrored = refine_outlines(*(np.ascontiguousarray(each[:, ::-1]) for each in (frame, labels, foreground)), *PARAMS)
    assert (mirrored[:, ::-1] != objects).mean() < 0.002


def test_an_outline_that_is_too_far_out_moves_back_to_the_border_of_the_colours():
    frame, labels, foreground = scene([(12, 30, 20, 44)])
    truth = enlarged(labels, frame) > 0
    wide = cv2.dilate(labels, np.ones((7, 7), np.uint8))
    halo = np.where(labels > 0, foreground, np.where(wide > 0, np.float32(0.8), foreground))
    without, found = (
        overlap(refine_outlines(frame, wide, halo, RefinementParams(), LocalColourParams(share=share)) > 0, truth)
        for share in (0, 1)
    )
    assert without < 0.8 and found > 0.97
