import numpy as np

from moseg.workflows.exports.draw_errors import ERROR_COLOURS, draw_errors
from moseg.workflows.exports.draw_point_errors import POINT_RADIUS, PointLabels, draw_point_errors

IMAGE = np.random.default_rng(0).integers(0, 256, (60, 80, 3)).astype(np.uint8)
DIM = draw_errors(IMAGE, np.zeros((60, 80), np.uint16), np.zeros((60, 80), np.uint16))


def test_each_point_has_the_colour_of_what_it_is_and_what_is_static_has_none():
    points = np.array([[10, 10], [30, 10], [50, 10], [70, 10]], float)
    labelled = PointLabels(points, np.uint16([3, 4, 0, 0]), np.uint16([2, 0, 2, 0]), (60, 80))
    drawn = draw_point_errors(IMAGE, labelled)
    assert [tuple(drawn[10, x]) for x in (10, 30, 50)] == list(ERROR_COLOURS.values())
    np.testing.assert_array_equal(drawn[:, 60:], DIM[:, 60:])
    y, x = np.nonzero((drawn != DIM).any(axis=-1))
    assert max(np.hypot(np.subtract.outer(x, points[:3, 0]), (y - 10)[:, None]).min(axis=1)) <= POINT_RADIUS + 0.5


def test_points_keep_their_place_in_a_smaller_picture():
    labelled = PointLabels(np.array([[100.5, 60.5]]), np.uint16([1]), np.uint16([1]), (120, 160))
    y, x = np.nonzero((draw_point_errors(IMAGE, labelled) == 255).all(axis=-1))
    assert (x.mean(), y.mean()) == (50, 30)


def test_errors_lie_above_what_is_right():
    points = np.array([[20, 20], [20, 20]], float)
    labelled = PointLabels(points, np.uint16([0, 1]), np.uint16([1, 1]), (60, 80))
    assert tuple(draw_point_errors(IMAGE, labelled)[20, 20]) == ERROR_COLOURS["false negative"]
