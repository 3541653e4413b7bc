"""Surroundings of an object: where the motion of other tracks would bring its points."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import ObjectPointParams
from moseg.tasks.object_points.motion import FramePair
from moseg.tasks.object_points.surroundings import Surroundings

PARAMS = ObjectPointParams()
SHAPE = (120, 200)
TEXTURE = cv2.normalize(
    cv2.GaussianBlur(np.random.default_rng(4).normal(size=SHAPE), (0, 0), 2.0), None, 0, 255, cv2.NORM_MINMAX
).astype(np.uint8)
SHIFT = np.float32([7, 3])
PAIR = FramePair(TEXTURE, cv2.warpAffine(TEXTURE, np.float64([[1, 0, 7], [0, 1, 3]]), SHAPE[::-1]), PARAMS)
TRACKS = np.float32([[x, y] for x in range(20, 180, 20) for y in range(20, 100, 20)])
POINTS = np.float32([[45, 33], [111, 71]])


def _around(shift, is_background=None):
    is_background = np.ones(len(TRACKS), bool) if is_background is None else is_background
    return Surroundings(TRACKS, np.tile(np.float32(shift), (len(TRACKS), 1)), is_background)


@pytest.mark.parametrize("off", [0, 2])
def test_points_go_where_the_nearest_tracks_go_and_are_tracked_from_there(off):
    found, is_background = _around(SHIFT + off).find(PAIR, POINTS)
    np.testing.assert_allclose(found.points, POINTS + SHIFT, atol=0.2)
    assert (found.correlation > 0.98).all() and found.is_tracked.all() and is_background.all()


def test_a_point_whose_surroundings_move_otherwise_does_not_correlate():
    found, _ = _around((-9, 10)).find(PAIR, POINTS)
    assert (found.correlation < 0.7).all() and not found.is_tracked.any()


def test_a_median_is_no_prey_of_single_tracks():
    around = _around(SHIFT)
    around.motion[::4] = (30, 30)
    np.testing.assert_allclose(around.find(PAIR, POINTS)[0].points, POINTS + SHIFT, atol=0.2)


def test_a_point_beside_another_mover_is_not_of_the_background():
    _, is_background = _around(SHIFT, TRACKS[:, 0] > 80).find(PAIR, POINTS)
    assert is_background.tolist() == [False, True]


@pytest.mark.parametrize("number", [0, 5])
def test_few_tracks_say_nothing(number):
    around = Surroundings(*(values[:number] for values in _around(SHIFT)))
    found, is_background = around.find(PAIR, POINTS)
    assert found.correlation.tolist() == [-1, -1] and not found.is_tracked.any() and not is_background.any()
