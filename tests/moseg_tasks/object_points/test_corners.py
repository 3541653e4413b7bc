"""New corners around an object's points."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import ObjectPointParams
from moseg.tasks.object_points.corners import new_corners
from moseg.tasks.object_points.motion import FramePair

PARAMS = ObjectPointParams()
SHAPE = (120, 200)
TEXTURE = cv2.normalize(
    cv2.GaussianBlur(np.random.default_rng(4).normal(size=SHAPE), (0, 0), 2.0), None, 0, 255, cv2.NORM_MINMAX
).astype(np.uint8)
PAIR = FramePair(TEXTURE, TEXTURE, PARAMS)


def test_new_corners_are_near_the_object_and_away_from_all_points():
    own, others = np.float32([[60, 60], [75, 60]]), np.float32([[66, 70], [50, 52]])
    corners = new_corners(TEXTURE, own, others, PAIR)
    assert len(corners) > 5
    distance = np.linalg.norm(corners[:, None] - own, axis=2).min(axis=1)
    assert distance.max() <= PARAMS.reach + 1
    assert np.linalg.norm(corners[:, None] - np.concatenate([own, others]), axis=2).min() >= PARAMS.spacing
    apart = np.linalg.norm(corners[:, None] - corners, axis=2) + 99 * np.eye(len(corners))
    assert apart.min() >= PARAMS.spacing


def test_corners_at_the_border_of_the_frame_are_inside():
    corners = new_corners(TEXTURE, np.float32([[0, 0], [199, 119]]), np.zeros((0, 2), np.float32), PAIR)
    assert len(corners) and (corners >= 0).all() and (corners <= [199, 119]).all()


def test_a_plain_frame_has_no_corners():
    plain = np.full(SHAPE, 90, np.uint8)
    assert new_corners(plain, np.float32([[60, 60]]), np.zeros((0, 2), np.float32), PAIR).shape == (0, 2)


@pytest.mark.parametrize(("number", "most"), [(4990, 10), (5000, 0), (6000, 0)])
def test_an_object_with_many_points_gets_few_new_ones(number, most):
    own = np.tile(np.float32([[60, 60]]), (number, 1))
    assert len(new_corners(TEXTURE, own, np.zeros((0, 2), np.float32), PAIR)) == most
