"""The camera's own vehicle, which rides along at the lower edge of the picture."""

import numpy as np
import pytest

from moseg.schemas.parameters import OwnVehicleParams
from moseg.tasks.track_objects import RegroupedTracks, without_own_vehicle

HEIGHT, WIDTH, NUM_FRAMES = 300, 600, 8
PARAMS = OwnVehicleParams()
RNG = np.random.default_rng(0)


def _block(columns, rows, motion, number=40):
    """Return tracks (number, frame, xy) that start in a box and move by `motion` px/frame."""
    start = RNG.uniform([columns[0], rows[0]], [columns[1], rows[1]], (number, 2))
    return start[:, None] + np.float64(motion) * (np.arange(NUM_FRAMES) - NUM_FRAMES / 2)[:, None]


def _drive(*groups):
    """Return groups of tracks, points and visibility: these blocks, in order, and a ground that passes by."""
    ground = _block((0, WIDTH), (220, 290), (2.0, 8.0), 100)
    blocks = [*groups, ground, _block((0, WIDTH), (20, 150), (0.5, 0.0), 50)]
    numbers = [*range(len(groups)), -1, -1]
    group = np.concatenate([np.full(len(block), number) for number, block in zip(numbers, blocks, strict=True)])
    points = np.concatenate(blocks).astype(np.float32)
    return RegroupedTracks(group, np.zeros(len(groups), bool)), points, np.ones(points.shape[:2], bool)


def _found(*groups, params=PARAMS):
    return without_own_vehicle(*_drive(*groups), (HEIGHT, WIDTH), params)


BONNET = _block((10, 590), (270, 299), (0.1, 0.3), 80)
CAR = _block((280, 340), (150, 190), (0.2, 0.0))


def test_a_bonnet_is_no_group_and_the_others_are_numbered_on():
    given, points, visible = _drive(BONNET, CAR)
    given = given._replace(is_static=np.array([False, True]))
    found = without_own_vehicle(given, points, visible, (HEIGHT, WIDTH), PARAMS)
    assert found.is_static.tolist() == [True]
    np.testing.assert_array_equal(found.group[given.group == 1], 0)
    assert (found.group[given.group != 1] == -1).all()


def test_parts_of_a_bonnet_count_together():
    left, right = (BONNET[(BONNET[:, 0, 0] < 350) == side] for side in (True, False))
    assert len(_found(left, CAR, right).is_static) == 1
    assert len(_found(right, CAR).is_static) == 2


@pytest.mark.parametrize(
    "block",
    [
        pytest.param(_block((10, 590), (270, 299), (1.5, 1.5)), id="moves-in-the-picture"),
        pytest.param(_block((10, 590), (210, 240), (0.1, 0.3)), id="does-not-reach-the-edge"),
        pytest.param(_block((10, 590), (120, 299), (0.1, 0.3)), id="reaches-up-to-the-horizon"),
        pytest.param(_block((200, 380), (270, 299), (0.1, 0.3)), id="is-narrow"),
    ],
)
def test_other_groups_stay(block):
    assert len(_found(block, CAR).is_static) == 2


def test_nothing_rides_along_where_the_ground_stands_still():
    groups, points, visible = _drive(BONNET, CAR)
    still = points[:, :1].repeat(NUM_FRAMES, axis=1)
    still[groups.group >= 0] = points[groups.group >= 0]
    assert without_own_vehicle(groups, still, visible, (HEIGHT, WIDTH), PARAMS) is groups


def test_tracks_of_the_vehicle_that_have_no_group_do_not_count_as_the_ground():
    groups, points, visible = _drive(BONNET, CAR)
    more = _block((10, 590), (270, 299), (0.1, 0.3), 110).astype(np.float32)
    groups = groups._replace(group=np.append(groups.group, np.full(len(more), -1)))
    points, visible = np.concatenate([points, more]), np.concatenate([visible, np.ones((len(more), NUM_FRAMES), bool)])
    assert len(without_own_vehicle(groups, points, visible, (HEIGHT, WIDTH), PARAMS).is_static) == 1


def test_without_a_ground_nothing_is_judged():
    groups, points, visible = _drive(BONNET)
    seen = (groups.group >= 0) | (points[:, 0, 1] < 200)
    few = RegroupedTracks(groups.group[seen], groups.is_static)
    assert without_own_vehicle(few, points[seen], visible[seen], (HEIGHT, WIDTH), PARAMS) is few


def test_tracks_of_single_frames_have_no_motion():
    groups, points, visible = _drive(BONNET, CAR)
    visible[groups.group == 0] = np.arange(NUM_FRAMES) == 3
    assert len(without_own_vehicle(groups, points, visible, (HEIGHT, WIDTH), PARAMS).is_static) == 2


def test_tracks_that_no_frame_shows_change_nothing():
    groups, points, visible = _drive(BONNET, CAR)
    visible[np.flatnonzero(groups.group == 0)[::4]] = False
    visible[np.flatnonzero(groups.group < 0)[::4]] = False
    assert len(without_own_vehicle(groups, points, visible, (HEIGHT, WIDTH), PARAMS).is_static) == 1


def test_the_vehicle_is_not_looked_for_where_none_is_wide_enough():
    assert len(_found(BONNET, CAR, params=PARAMS.model_copy(update={"min_width": 1.1})).is_static) == 2
