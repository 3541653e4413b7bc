"""Surfaces of tracks that stand above the ground, in exact drives along a street."""

from typing import NamedTuple

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams, TrackSurfaceParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.ground import Ground
from moseg.tasks.track_objects import find_surfaces

PARAMS, RIGIDITY = TrackSurfaceParams(), RigidityParams()
SHAPE, FOCAL, CAMERA_HEIGHT = (375, 1242), 900.0, 1.5
CENTRE = (np.array(SHAPE[::-1]) - 1) / 2
ADVANCE = 0.25
NUM_FRAMES, GAPS = 9, (2, 4)
AHEAD = CameraMotion(np.eye(3), np.array([0.0, 0.0, -1.0]), FOCAL)
CAR, POST, VAN, ROAD = range(4)


class Street(NamedTuple):
    """Arguments of `find_surfaces` about tracks and pairs, and the part of the street that each track is of."""

    points: np.ndarray
    visible: np.ndarray
    pairs: np.ndarray
    grounds: list[Ground | None]
    part: np.ndarray


def _grid(x, y, z):
    """Return the points (N, 3) of all combinations of coordinates: x right, y down, z ahead."""
    return np.stack(np.meshgrid(x, y, z), axis=-1).reshape(-1, 3)


FACES = (
    _grid(np.arange(1, 2.6, 0.15), np.arange(-0.2, 1.05, 0.15), [14.0]),
    _grid([-1.6, -1.5], np.arange(-0.5, 1.05, 0.15), [9.0]),
    # Beside the car in the frame, and farther away.
    _grid(np.arange(3.75, 5, 0.2), np.arange(-0.3, 1.15, 0.2), [20.0]),
)
"""Upright parts of the street: the front of a car, a post, the front of a van."""
GROUND = _grid(np.arange(-3, 3.1, 0.4), [CAMERA_HEIGHT], np.arange(7, 20, 0.7))


def _street(*faces, speeds=None, num_frames=NUM_FRAMES):
    """Return the tracks of faces (N, 3), each of which comes by its speed per frame, and of the ground."""
    world = (*faces, GROUND)
    part = np.repeat(range(len(world)), [len(each) for each in world])
    speed = np.array([*(speeds or [0.0] * len(faces)), 0.0])[part]
    places = []
    for frame in range(num_frames):
        x, y, z = (np.concatenate(world) - np.outer(ADVANCE + speed, [0, 0, frame])).T
        places.append(FOCAL * np.stack([x, y], axis=1) / z[:, None] + CENTRE)
    pairs = np.array([(first, gap) for gap in GAPS for first in range(num_frames - gap)], np.int32).reshape(-1, 2)
    # Inverse depth is in units of the camera's travel in the pair.
    slopes = [np.array([0.0, gap * ADVANCE / (CAMERA_HEIGHT * FOCAL)]) for _, gap in pairs]
    points = np.stack(places, axis=1).astype(np.float32)
    return Street(points, np.ones(points.shape[:2], bool), pairs, [Ground(slope, CENTRE) for slope in slopes], part)


def _find(street, cameras=None, **changes):
    cameras = [AHEAD] * len(street.pairs) if cameras is None else cameras
    params = PARAMS.model_copy(update=changes)
    tracks = street.points, street.visible
    return find_surfaces(*tracks, street.pairs, cameras, street.grounds, SHAPE, params, RIGIDITY)


def test_neighbours_at_one_depth_are_a_surface_and_the_ground_is_none():
    street = _street(*FACES)
    found = _find(street)
    assert found.dtype == np.uint16
    assert not found[street.part == ROAD].any()
    # By falling number of tracks.
    assert [np.unique(found[street.part == part]).tolist() for part in (CAR, VAN, POST)] == [[1], [2], [3]]


def test_neighbours_at_other_depths_are_told_apart_as_finely_as_asked():
    street = _street(*FACES)
    gap = street.points[street.part == VAN, 0, 0].min() - street.points[street.part == CAR, 0, 0].max()
    assert 0 < gap < PARAMS.radius
    assert _find(street).max() == 3
    joined = _find(street, agreement=0.5)
    assert len({*joined[street.part == CAR], *joined[street.part == VAN]}) == 1
    assert not _find(_street(FACES[CAR]), agreement=0.0, noise=0.0).any()


def test_a_wall_that_leads_away_is_one_surface():
    wall = _grid([-3.0], np.arange(-0.6, 1.05, 0.2), 9 * 1.025 ** np.arange(25))
    street = _street(wall)
    found = _find(street)
    assert (found[street.part == 0] == 1).all()
    assert found.max() == 1


def test_what_moves_has_surfaces_too():
    street = _street(FACES[CAR], speeds=[0.3])
    assert (_find(street)[street.part == 0] == 1).all()


@pytest.mark.parametrize(("changes", "is_found"), [({}, True), ({"min_tracks": 22}, True), ({"min_tracks": 23}, False)])
def test_a_surface_has_a_smallest_number_of_tracks(changes, is_found):
    street = _street(FACES[POST])
    assert len(FACES[POST]) == 22
    assert _find(street, **changes).any() == is_found


def test_tracks_far_from_each_other_are_not_compared():
    street = _street(FACES[CAR])
    # They are about 10 px apart, and 13 px at the end.
    assert not _find(street, radius=8.0).any()
    assert _find(street, radius=15.0).max() == 1


def test_a_track_that_stands_in_half_of_its_pairs_does_stand():
    # What is above the horizon hides no ground, however high that is.
    street = _street(FACES[CAR][FACES[CAR][:, 1] > 0.2])
    widest = np.flatnonzero(street.pairs[:, 1] == max(GAPS))
    high = Ground(street.grounds[widest[0]].slope * 10, CENTRE)
    for num_low, stands in ((3, True), (2, False)):
        grounds = list(street.grounds)
        for index in widest[num_low:]:
            grounds[index] = high
        assert len(widest) == 5
        assert _find(street._replace(grounds=grounds)).any() == stands


def test_a_slip_in_one_pair_parts_no_surface():
    street = _street(FACES[CAR])
    points = street.points.copy()
    corner = 0
    # Away from the epipole, as if it were at half the distance.
    points[corner, -1] += 0.1 * (points[corner, -1] - CENTRE)
    # With few neighbours, which are the same in all pairs.
    assert (_find(street._replace(points=points), num_neighbours=2)[street.part == 0] == 1).all()
    unsure = street._replace(points=points, pairs=street.pairs[-1:], grounds=street.grounds[-1:])
    assert _find(unsure, num_neighbours=2)[corner] == 0


def test_only_pairs_of_the_largest_gap_with_a_ground_are_read():
    street = _street(*FACES)
    expected = _find(street)
    aside = AHEAD._replace(translation=np.array([-1.0, 0.0, 0.0]))
    cameras = [AHEAD if gap == max(GAPS) else aside for _, gap in street.pairs]
    np.testing.assert_array_equal(_find(street, cameras), expected)
    grounds, cameras = list(street.grounds), [AHEAD] * len(street.pairs)
    grounds[-1], cameras[-1] = None, aside
    np.testing.assert_array_equal(_find(street._replace(grounds=grounds), cameras), expected)


@pytest.mark.parametrize("num_frames", [1, 5])
def test_without_a_pair_that_shows_the_ground_there_is_no_surface(num_frames):
    street = _street(*FACES, num_frames=num_frames)
    street = street._replace(grounds=[None] * len(street.pairs))
    found = _find(street)
    assert (found.dtype, len(found), found.any()) == (np.uint16, len(street.points), False)


@pytest.mark.parametrize("num_tracks", [0, 1, 2])
def test_hardly_any_tracks_are_no_surface_but_a_small_one_if_asked_for(num_tracks):
    street = _street(FACES[CAR])
    street = street._replace(points=street.points[:num_tracks], visible=street.visible[:num_tracks])
    assert _find(street).tolist() == [0] * num_tracks
    assert _find(street, min_tracks=2).tolist() == ([1, 1] if num_tracks == 2 else [0] * num_tracks)


def test_one_surface_may_be_all_tracks():
    street = _street(FACES[CAR])
    of_car = street.part == 0
    assert (_find(street._replace(points=street.points[of_car], visible=street.visible[of_car])) == 1).all()


def test_a_track_that_no_pair_sees_is_of_no_surface_and_hidden_places_are_not_read():
    street = _street(*FACES)
    visible, points = street.visible.copy(), street.points.copy()
    visible[0, 1:] = False
    visible[1::3, 6:] = False
    points[~visible] = np.nan
    found = _find(street._replace(points=points, visible=visible))
    assert found[0] == 0
    np.testing.assert_array_equal(found[1:], _find(street)[1:])


def test_the_order_of_tracks_does_not_matter():
    street = _street(*FACES)
    order = np.random.default_rng(0).permutation(len(street.points))
    shuffled = street._replace(points=street.points[order], visible=street.visible[order])
    np.testing.assert_array_equal(_find(shuffled), _find(street)[order])


def test_surfaces_past_the_largest_label_are_left_out():
    largest = np.iinfo(np.uint16).max
    many = _grid(np.linspace(1, 3, 300), np.linspace(-1, 1, 220), [14.0])
    street = _street(many, num_frames=max(GAPS) + 1)
    found = _find(street, radius=1e-6, min_tracks=1)
    assert len(many) > largest
    assert np.bincount(found[street.part == 0]).tolist() == [len(many) - largest, *[1] * largest]
