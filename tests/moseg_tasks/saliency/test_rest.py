"""A camera is at rest where two opposite borders are, however much of the frame moves."""

import numpy as np
import pytest

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency import BackgroundChoice, estimate_saliency
from moseg.tasks.saliency.rest import is_at_rest

SHAPE = HEIGHT, WIDTH = (96, 160)
BAND = 14  # 0.15 of the height
PARAMS = SaliencyParams(working_side=WIDTH)
BANDS = {"left": np.s_[:, :BAND], "right": np.s_[:, -BAND:], "top": np.s_[:BAND, :], "bottom": np.s_[-BAND:, :]}


@pytest.fixture
def image():
    return np.random.default_rng(0).integers(0, 256, (*SHAPE, 3)).astype(np.float32)


def _flow(*at_rest, rest=0.0, speed=3.0):
    """Return a flow of `speed` px/frame to the right, and of `rest` in some bands along the border."""
    flow = np.zeros((*SHAPE, 2), np.float32)
    flow[..., 0] = speed
    for band in at_rest:
        flow[(*BANDS[band], 0)] = rest
    return flow


def _with(band, value, array):
    array = array.copy()
    array[BANDS[band]] = value
    return array


@pytest.mark.parametrize(
    ("at_rest", "expected"),
    [
        (("left", "right"), True),
        (("top", "bottom"), True),
        (("left", "top"), False),
        (("bottom",), False),
        ((), False),
        (("left", "right", "top", "bottom"), True),
    ],
)
def test_two_opposite_borders_decide(image, at_rest, expected):
    assert is_at_rest(_flow(*at_rest), image, PARAMS) is expected


@pytest.mark.parametrize(("speed", "expected"), [(0.04, True), (0.06, False), (-0.06, False)])
def test_a_slow_camera_is_not_at_rest(image, speed, expected):
    assert is_at_rest(_flow("left", "right", rest=speed), image, PARAMS) is expected


def test_at_a_threshold_of_zero_no_camera_is(image):
    assert not is_at_rest(_flow(speed=0.0), image, PARAMS.model_copy(update={"rest_motion": 0.0}))


def test_a_plain_wall_shows_nothing(image):
    """Neither do panels at both sides of the video, which rest whatever the camera does."""
    flow = _flow("left", "right")
    assert not is_at_rest(flow, _with("left", 128, image), PARAMS)
    assert not is_at_rest(flow, _with("right", 128, image), PARAMS)
    faint = 128 + (image - 128) * np.float32(0.02)
    assert not is_at_rest(flow, faint, PARAMS)
    assert is_at_rest(flow, faint, PARAMS.model_copy(update={"rest_gradient": 0.1}))


def test_pixels_without_texture_do_not_count(image):
    """Flow across a wall may be anything."""
    flow, plain = _flow("left", "right"), image.copy()
    flow[:70, :BAND, 0] = 3.0
    assert not is_at_rest(flow, plain, PARAMS)
    plain[:70, :BAND] = 128
    assert is_at_rest(flow, plain, PARAMS)
    flow[:70, :BAND, 0], flow[70:, :BAND, 0] = 0.0, 3.0
    assert not is_at_rest(flow, plain, PARAMS)


@pytest.mark.parametrize(("share", "expected"), [(0.3, False), (0.5, True)])
def test_enough_of_a_border_must_be_at_rest(image, share, expected):
    flow = _flow("left", "right")
    flow[round(share * HEIGHT) :, -BAND:, 0] = 3.0
    assert is_at_rest(flow, image, PARAMS) is expected


def test_a_frame_without_texture_is_not_at_rest():
    assert not is_at_rest(_flow(speed=0.0), np.full((*SHAPE, 3), 90, np.float32), PARAMS)
    assert not is_at_rest(np.zeros((1, 1, 2), np.float32), np.zeros((1, 1, 3), np.float32), PARAMS)


@pytest.mark.parametrize("model", ["layers", "rigid"])
def test_what_fills_most_of_the_frame_before_a_camera_at_rest_moves(image, model):
    """The motion of most of the frame would be the background's, and what is still would move."""
    flow = _flow("left", "right")
    frame, other = image.astype(np.uint8), image.astype(np.uint8)
    moved = np.roll(other, 3, axis=1)
    other[:, BAND:-BAND] = moved[:, BAND:-BAND]
    found = estimate_saliency(frame, None, other, None, flow, PARAMS, BackgroundChoice(model))
    assert found.saliency[:, 30:-30].min() > 0.9 and found.saliency[:, : BAND // 2].max() < 0.1
    assert np.array_equal(found.residual_flows[1].astype(np.float32), flow)
    assert not found.first_layers[1].theta.any()
    fitted = estimate_saliency(
        frame, None, other, None, flow, PARAMS.model_copy(update={"rest_motion": 0.0}), BackgroundChoice()
    )
    assert fitted.saliency[:, 30:-30].max() < 0.1
