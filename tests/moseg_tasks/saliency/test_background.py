import numpy as np
import pytest

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.background import affine_flow, fit_background, sample_flow
from moseg.tasks.saliency.grid import pixel_grid
from moseg.tasks.saliency.layers import fit_layers, typical_residual

PARAMS = SaliencyParams()
SHAPE = (120, 200)


def affine_field(constant=(2.0, -1.0), along_x=(0.01, 0.004), along_y=(-0.006, 0.02)) -> np.ndarray:
    centred = pixel_grid(SHAPE).astype(np.float64) - [(SHAPE[1] - 1) / 2, (SHAPE[0] - 1) / 2]
    x, y = centred[..., :1], centred[..., 1:]
    return (np.array(constant) + x * np.array(along_x) + y * np.array(along_y)).astype(np.float32)


def test_an_exact_affine_flow_is_recovered():
    motion = fit_background(affine_field(), PARAMS)
    np.testing.assert_allclose(motion.theta[1:], [[0.01, 0.004], [-0.006, 0.02]], atol=1e-5)
    np.testing.assert_allclose(affine_flow(motion, SHAPE), affine_field(), atol=1e-3)


def test_an_object_on_a_quarter_of_the_frame_does_not_bend_the_background():
    flow = affine_field()
    flow[30:90, 60:160] += np.array([4.0, 3.0], np.float32)
    np.testing.assert_allclose(affine_flow(fit_background(flow, PARAMS), SHAPE), affine_field(), atol=1e-2)


def fills_most() -> np.ndarray:
    """An object on three fifths of the frame, whose surroundings are seen all along the border."""
    flow = affine_field()
    flow[14:106, 22:178] += np.array([4.0, 3.0], np.float32)
    return flow


def test_an_object_that_fills_three_fifths_of_the_middle_does_not_become_the_background():
    followed = affine_flow(fit_background(fills_most(), PARAMS), SHAPE)
    np.testing.assert_allclose(followed, affine_field(), atol=1e-2)


@pytest.mark.parametrize("even", [{"centre_thinning": 1}, {"border_band": 0.5, "centre_thinning": 1}])
def test_without_a_higher_weight_of_the_border_that_object_is_the_background(even):
    followed = affine_flow(fit_background(fills_most(), PARAMS.model_copy(update=even)), SHAPE)
    assert np.abs(followed - affine_field()).min() > 2.5


def test_a_fit_among_given_pixels_uses_all_of_them():
    flow = fills_most()
    followed = affine_flow(fit_background(flow, PARAMS, np.ones(SHAPE, bool)), SHAPE)
    np.testing.assert_allclose(followed[14:106, 22:178], flow[14:106, 22:178], atol=1e-2)


def test_the_band_along_the_border_is_sampled_in_full_and_a_share_of_the_middle():
    flow = affine_field()
    points, vectors = sample_flow(flow, 6, thinning=PARAMS)
    x, y = points.T
    from_border = np.minimum.reduce([x, SHAPE[1] - 1 - x, y, SHAPE[0] - 1 - y])
    in_band = from_border < PARAMS.border_band * SHAPE[0]
    rows, columns = np.mgrid[3:120:6, 3:200:6]
    everywhere = np.minimum.reduce([columns, SHAPE[1] - 1 - columns, rows, SHAPE[0] - 1 - rows])
    band = everywhere < PARAMS.border_band * SHAPE[0]
    assert in_band.sum() == band.sum()
    assert (~in_band).sum() == pytest.approx((~band).sum() / PARAMS.centre_thinning, abs=2)
    np.testing.assert_array_equal(vectors, flow[y.astype(int), x.astype(int)])


def test_the_fit_is_the_same_bytes_each_time_and_leaves_its_input():
    flow = affine_field() + np.random.default_rng(0).normal(0, 0.3, (*SHAPE, 2)).astype(np.float32)
    copy = flow.copy()
    assert fit_background(flow, PARAMS).theta.tobytes() == fit_background(flow, PARAMS).theta.tobytes()
    assert np.array_equal(flow, copy)


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (5, 5), (13, 2)])
def test_frames_too_small_for_a_homography_still_have_a_background(shape):
    flow = np.full((*shape, 2), 1.5, np.float32)
    np.testing.assert_allclose(affine_flow(fit_background(flow, PARAMS), shape), flow, atol=1e-4)


def two_layers() -> np.ndarray:
    """A far scene above, and below it ground that moves on its own affine way, on the grid of a usual frame."""
    flow = np.zeros((240, 427, 2), np.float32)
    flow[140:] = np.array([6.0, 0.0], np.float32)
    return flow


def test_ground_along_the_border_becomes_a_second_layer():
    background = fit_layers(two_layers(), PARAMS)
    assert background.residual.max() < 1e-3
    np.testing.assert_allclose(background.flow, two_layers(), atol=1e-3)


def test_an_object_inside_the_frame_never_becomes_a_layer():
    flow = np.zeros((*SHAPE, 2), np.float32)
    flow[40:100, 50:150] = [6.0, 0.0]
    np.testing.assert_allclose(fit_layers(flow, PARAMS).residual[40:100, 50:150], 6.0, atol=1e-2)


def test_the_second_layer_can_be_refused():
    refused = fit_layers(two_layers(), PARAMS.model_copy(update={"layer_border": 1.0}))
    assert refused.residual[150:].min() > 3


def test_a_wall_along_one_side_becomes_a_second_layer():
    flow = np.zeros((240, 427, 2), np.float32)
    flow[:, :40] = [6.0, 0.0]
    assert fit_layers(flow, PARAMS).residual.max() < 1e-3


def test_the_typical_residual_is_not_that_of_an_object_that_fills_most_of_the_frame():
    residual = np.full((120, 200), 0.1, np.float32)
    residual[20:100, 20:180] = 5
    assert typical_residual(residual, 0.15) == pytest.approx(0.1)
    assert typical_residual(5.1 - residual, 0.15) == pytest.approx(0.1)
