"""An object that returns after a long gap has its identity back if colour, size and path agree."""

import numpy as np

from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.proposals.returning import find_returns, see_objects

PARAMS = IdentityParams()
SHAPE, LENGTH = (60, 240), 30
RED, BLUE = (200, 40, 40), (40, 40, 200)
STARTS = (0, LENGTH)


def see(rows, path, colour=RED, size=16, camera=0.0):
    """Sightings of a section in which a square is at path(row) in some rows."""
    labels, images = np.zeros((LENGTH, *SHAPE), np.uint16), np.full((LENGTH, *SHAPE, 3), 90, np.uint8)
    residual = np.zeros((LENGTH, 2, *SHAPE, 2), np.float32)
    for t in rows:
        x, top = round(path(t) + camera * t), (SHAPE[0] - size) // 2
        inside = (slice(top, top + size), slice(x - size // 2, x + size // 2))
        labels[t][inside], images[t][inside] = 1, colour
        for direction, other in ((0, t - 1), (1, t + 1)):
            residual[t, direction][inside] = (path(other) - path(t), 0)
    flows = residual + np.float32([[-camera, 0], [camera, 0]])[None, :, None, None]
    return see_objects(labels, images, flows, residual, PARAMS)


def returned(after, before=None, params=PARAMS):
    before = see(range(2, 10), lambda t: 20 + 3 * t) if before is None else before
    identity = np.array([[0, 1], [0, 2]], np.uint16)
    return find_returns(identity, STARTS, (before, after), SHAPE[0] * SHAPE[1], params)[:, 1].tolist()


def on_course(**look):
    return see(range(5, 15), lambda t: 20 + 3 * (t + LENGTH), **look)


def test_it_has_its_identity_back_after_25_frames():
    assert returned(on_course()) == [1, 1]


def test_the_camera_s_motion_is_part_of_the_path():
    before = see(range(2, 10), lambda t: 20 + 3 * t, camera=1.0)
    after = see(range(5, 15), lambda t: 50 + 3 * (t + LENGTH) - 30, camera=1.0)
    shifted = see(range(5, 15), lambda t: 50 + 3 * (t + LENGTH), camera=1.0)
    assert returned(shifted, before) == [1, 1] and returned(after, before) == [1, 2]


def test_another_colour_size_or_place_is_another_object():
    elsewhere = see(range(5, 15), lambda t: 180 - 3 * t)
    for other in (on_course(colour=BLUE), on_course(size=40), elsewhere):
        assert returned(other) == [1, 2]


def test_it_is_another_object_after_too_long_a_gap():
    assert returned(on_course(), params=PARAMS.model_copy(update={"return_gap": 20})) == [1, 2]


def test_an_object_with_a_part_of_another_source_is_left_alone():
    identity = np.array([[0, 1], [0, 1]], np.uint16)
    seen = (see(range(2, 10), lambda t: 20 + 3 * t), None)
    np.testing.assert_array_equal(find_returns(identity, STARTS, seen, SHAPE[0] * SHAPE[1], PARAMS), identity)
