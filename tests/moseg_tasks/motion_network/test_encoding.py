import cv2
import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.motion_network import CHANNELS, Neighbour, encode_motion
from moseg.tasks.motion_network.encoding import PER_DIRECTION

SHAPE = (96, 160)
BACKGROUND = np.array([2.0, 1.0], np.float32)
OBJECT = (slice(36, 64), slice(60, 100))
PARAMS = SaliencyParams()
FRAME = cv2.GaussianBlur(np.random.default_rng(0).integers(0, 256, (*SHAPE, 3), np.uint8), (0, 0), 1.0)


def neighbour(sign: float, scale: float = 1.0, own=(3.0, 0.0)) -> Neighbour:
    """The frame after (1) or before (-1): the background moves, and the square in addition to it."""
    flow = np.tile(sign * scale * BACKGROUND, (*SHAPE, 1))
    residual = np.zeros_like(flow)
    residual[OBJECT] = sign * scale * np.array(own, np.float32)
    image = np.roll(FRAME, (round(sign), round(2 * sign)), axis=(0, 1)).astype(np.float32)
    return Neighbour(image, flow + residual, -(flow + residual), residual)


def channel(encoded: np.ndarray, name: str) -> np.ndarray:
    return encoded[CHANNELS.index(name)].astype(np.float32)


def encode(previous, following) -> np.ndarray:
    return encode_motion(FRAME.astype(np.float32), previous, following, PARAMS)


def test_what_moves_differs_from_the_background_in_the_channels_of_residual_motion():
    encoded = encode(neighbour(-1), neighbour(1))
    assert encoded.dtype == np.float16 and encoded.shape == (len(CHANNELS), *SHAPE)
    for name in ("residual_u_previous", "residual_u_next", "relative_u_next", "remainder_next"):
        assert channel(encoded, name)[44:56, 70:90].min() > 1
        assert np.abs(channel(encoded, name)[:20]).max() < 0.3


def test_vectors_of_both_directions_have_the_sense_of_time():
    encoded = encode(neighbour(-1), neighbour(1))
    for name in ("residual_u", "relative_u", "flow_u", "flow_v"):
        np.testing.assert_allclose(
            channel(encoded, f"{name}_previous")[44:56, 70:90],
            channel(encoded, f"{name}_next")[44:56, 70:90],
            atol=0.05,
        )


def test_at_the_ends_of_a_video_the_other_direction_stands_in():
    encoded = encode(None, neighbour(1))
    count = len(PER_DIRECTION)
    np.testing.assert_array_equal(encoded[:count], encoded[count : 2 * count])
    assert not encode(None, None).any()


def test_relative_channels_do_not_depend_on_speed():
    slow, fast = (encode(None, neighbour(1, scale)) for scale in (1.0, 3.0))
    for name in ("relative_u_next", "flow_u_next"):
        np.testing.assert_allclose(channel(slow, name), channel(fast, name), atol=0.05)


def test_channels_are_limited_and_a_large_grid_is_reduced():
    shape = (240, 427)
    flow = np.random.default_rng(1).normal(0, 300, (*shape, 2)).astype(np.float32)
    image = np.zeros((*shape, 3), np.float32)
    encoded = encode_motion(image, None, Neighbour(255 - image, flow, flow, flow), PARAMS)
    assert encoded.shape == (len(CHANNELS), 120, 213)
    assert np.isfinite(encoded).all() and np.abs(encoded).max() <= 8
