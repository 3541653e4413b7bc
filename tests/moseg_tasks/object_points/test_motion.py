"""Motions of one object between two frames, and where they bring its points."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import ObjectPointParams
from moseg.tasks.object_points.motion import FramePair, track_near
from moseg.tasks.object_points.similarities import move

PARAMS = ObjectPointParams()
SHAPE = (120, 200)
TEXTURE = cv2.normalize(
    cv2.GaussianBlur(np.random.default_rng(2).normal(size=SHAPE), (0, 0), 2.0), None, 0, 255, cv2.NORM_MINMAX
).astype(np.uint8)
POINTS = np.float32([[x, y] for x in range(20, 190, 17) for y in range(20, 110, 15)])
RIGHT, DOWN = (np.float64([[1, 0, x], [0, 1, y]]) for x, y in ((14, 0), (0, 11)))
IS_LEFT = POINTS[:, 0] < 80


def _moved(similarity):
    return cv2.warpAffine(TEXTURE, similarity, SHAPE[::-1], borderMode=cv2.BORDER_REFLECT)


def _pair(second, **changes):
    return FramePair(TEXTURE, second, PARAMS.model_copy(update=changes))


def _torn():
    """Return a second frame: what was left of column 80 has moved down, and the rest to the right."""
    second = _moved(RIGHT)
    second[:, :87] = _moved(DOWN)[:, :87]
    return second


def test_a_motion_is_refined_from_a_start_that_is_some_pixels_off():
    grown = np.float64([[1.3, 0, -20], [0, 1.3, -10]])
    start = grown + np.float64([[0.03, 0, 2], [0, 0.03, -2]])
    (found,) = _pair(_moved(grown)).motions(POINTS, move(start, POINTS), POINTS, [])
    np.testing.assert_allclose(move(found, POINTS), move(grown, POINTS), atol=0.4)


def test_tracks_and_the_motion_before_give_one_motion_if_they_agree():
    shown = POINTS[:8]
    found = _pair(_moved(RIGHT)).motions(shown, shown + np.float32([14, 0]), POINTS, [RIGHT])
    assert len(found) == 1
    # Without tracks that both frames show, the motion before is all there is.
    none = POINTS[:0]
    assert len(_pair(_moved(RIGHT)).motions(none, none, POINTS, [RIGHT])) == 1
    assert _pair(_moved(RIGHT)).motions(none, none, POINTS, []) == []


def test_an_object_may_have_several_motions_and_a_point_goes_with_the_one_that_its_patch_shows():
    pair = _pair(_torn())
    ends = np.where(IS_LEFT[:, None], POINTS + np.float32([0, 11]), POINTS + np.float32([14, 0]))
    motions = pair.motions(POINTS, ends, POINTS, [])
    assert len(motions) == 2
    found = pair.find(motions, POINTS)
    sure = (abs(POINTS[:, 0] - 83) > 20) & (ends < np.array(SHAPE[::-1]) - 12).all(axis=1)
    np.testing.assert_allclose(found.points[sure], ends[sure], atol=0.5)
    assert (found.correlation[sure] > 0.9).all()
    assert len(_pair(_torn(), max_motions=1).motions(POINTS, ends, POINTS, [])) == 1


def test_a_motion_needs_a_share_of_the_points():
    ends = np.where(IS_LEFT[:, None], POINTS + np.float32([0, 11]), POINTS + np.float32([14, 0]))
    share = IS_LEFT.mean()
    assert len(_pair(_torn(), min_share=share + 0.15).motions(POINTS, ends, POINTS, [])) == 1
    assert _pair(_torn(), min_share=1.0).motions(POINTS, ends, POINTS, []) == []


def test_points_outside_the_frame_are_nowhere():
    found = _pair(_moved(RIGHT)).find([RIGHT], np.float32([[190, 50], [100, 50], [199, 119]]))
    np.testing.assert_array_equal(found.correlation == -1, [True, False, True])
    np.testing.assert_array_equal(found.is_tracked, [False, True, False])
    away = _pair(_moved(RIGHT)).find([np.float64([[1, 0, 900], [0, 1, 0]])], POINTS)
    assert (away.correlation == -1).all() and not away.is_tracked.any()


@pytest.mark.parametrize(("slip", "is_tracked"), [(10.0, True), (2.0, False)])
def test_what_is_found_far_from_where_the_motion_leads_does_not_count(slip, is_tracked):
    off = RIGHT + np.float64([[0, 0, -4], [0, 0, 0]])
    point = np.float32([[100, 60]])
    found = _pair(_moved(RIGHT), slip=slip).find([off], point)
    assert found.is_tracked.tolist() == [is_tracked]
    np.testing.assert_allclose(found.points, move(RIGHT if is_tracked else off, point), atol=0.3)


def test_no_points_are_tracked_nowhere():
    points, is_near = track_near(TEXTURE, TEXTURE, POINTS[:0], POINTS[:0], 15, 2, PARAMS)
    assert points.shape == (0, 2) and is_near.shape == (0,)
