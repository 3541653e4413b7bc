import numpy as np
import pytest

from moseg.tasks.frame_grid import flow_on_grid, frame_on_grid, grid_shape, reduced_shape, resample


@pytest.mark.parametrize(
    ("frame", "grid"),
    [
        ((480, 854), (240, 427)),
        ((720, 1280), (240, 427)),
        ((1, 4000), (1, 427)),
        ((240, 426), (240, 426)),
        ((240, 390), (240, 390)),
        ((240, 320), (320, 427)),
        ((120, 160), (240, 320)),
        ((3, 2), (6, 4)),
    ],
)
def test_the_grid_has_its_longer_side_but_not_a_little_more_than_the_frame_nor_more_than_twice_of_it(frame, grid):
    assert grid_shape(frame, 427) == grid


@pytest.mark.parametrize("frame", [(480, 854), (240, 320), (1, 4000), (3, 2)])
def test_a_reduced_shape_is_never_an_enlargement(frame):
    height, width = reduced_shape(frame, 427)
    assert max(height, width) == min(427, max(frame)) and height <= frame[0] and width <= frame[1]


def test_images_are_averaged_on_coarser_grids_and_interpolated_on_finer_ones():
    ramp = np.tile(np.arange(0, 160, 8, dtype=np.uint8), (10, 1))
    image = np.stack([ramp, ramp // 2, 255 - ramp], axis=-1)
    half = resample(image, (5, 10))
    assert half.dtype == np.uint8 and half.shape == (5, 10, 3)
    np.testing.assert_array_equal(half[..., 0], np.tile(np.arange(4, 160, 16), (5, 1)))
    twice = resample(image, (20, 40))
    np.testing.assert_allclose(twice[:, 4:-4, 0], np.tile(np.arange(14, 142, 4), (20, 1)), atol=1)
    assert resample(ramp, (20, 40)).shape == (20, 40)


def test_an_image_on_its_own_grid_is_itself():
    image = np.zeros((4, 6, 3), np.uint8)
    assert resample(image, (4, 6)) is image


def test_frames_have_grey_levels_on_a_grid():
    frame = np.full((4, 6, 3), (10, 20, 30), np.uint8)
    on_grid = frame_on_grid(frame, (8, 12))
    assert on_grid.dtype == np.float32
    np.testing.assert_array_equal(on_grid, np.tile(np.float32([10, 20, 30]), (8, 12, 1)))


@pytest.mark.parametrize("grid", [(90, 160), (45, 80), (30, 40), (22, 40), (11, 20)])
def test_flow_is_in_pixels_of_the_grid_that_is_asked_for_whatever_its_own(grid):
    flow = np.full((*grid, 2), (8.0, -3.0), np.float32)
    np.testing.assert_allclose(flow_on_grid(flow, (30, 40), (90, 160)), np.full((30, 40, 2), (2.0, -1.0)), atol=1e-6)
    np.testing.assert_allclose(flow_on_grid(flow, (180, 320), (90, 160)), np.full((180, 320, 2), (16.0, -6.0)))


def test_the_size_of_frames_is_that_of_their_flow_unless_it_is_given():
    flow = np.full((90, 160, 2), (8.0, -3.0), np.float32)
    np.testing.assert_allclose(flow_on_grid(flow, (30, 40)), np.full((30, 40, 2), (2.0, -1.0)), atol=1e-6)
    assert flow_on_grid(flow, (90, 160)).dtype == np.float32


def test_flow_on_a_grid_of_other_proportions_is_in_pixels_of_both_its_axes():
    flow = np.full((48, 80, 2), (8.0, 4.0), np.float32)
    np.testing.assert_allclose(flow_on_grid(flow, (24, 80), (96, 160)), np.full((24, 80, 2), (4.0, 1.0)))
