"""The camera's motion in several frame pairs, each also sought from those of the others."""

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity import camera_motions
from moseg.tasks.rigidity.camera_motions import PairTracks, fit_motions

PARAMS = RigidityParams()
SHAPE, FOCAL = (375, 1242), 0.73
AHEAD = np.array([-np.sin(0.01), 0, -np.cos(0.01)])
ACROSS = np.array([1.0, 0.0, 0.0])


@pytest.fixture
def street(walls, road):
    return np.concatenate([walls, road])


@pytest.fixture
def misled(monkeypatch):
    """Function that lets the fit of the pair of a number go wrong: the camera seems to travel to its side."""
    fit = camera_motions.fit_pose

    def mislead(number):
        calls = iter(range(100))

        def fit_pose(*args):
            motion = fit(*args)
            return motion._replace(translation=ACROSS) if next(calls) == number else motion

        monkeypatch.setattr(camera_motions, "fit_pose", fit_pose)

    return mislead


def _pairs(see, street, starts=(0, 3, 6), **motion):
    drive = see(street, **motion)
    return [PairTracks(start, drive.points0, drive.points1) for start in starts]


def _angle(motion: CameraMotion, direction: np.ndarray) -> float:
    """Return the angle between the direction in which the camera travels and another one, degrees."""
    return float(np.degrees(np.arccos(np.clip(motion.translation @ direction, -1, 1))))


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_wrong_motion_is_mended_by_those_near_in_time(see, street, misled, number):
    misled(number)
    motions = fit_motions(_pairs(see, street), FOCAL, SHAPE, PARAMS)
    assert max(_angle(motion, AHEAD) for motion in motions) < 0.5


@pytest.mark.parametrize("reach", [2, 3])
def test_only_pairs_within_reach_are_asked(see, street, misled, reach):
    misled(1)
    motions = fit_motions(_pairs(see, street), FOCAL, SHAPE, PARAMS.model_copy(update={"pose_reach": reach}))
    assert (_angle(motions[1], AHEAD) < 0.5) == (reach >= 3)


def test_with_a_reach_of_none_each_pair_has_its_own_motion(see, street, misled):
    misled(1)
    pairs = _pairs(see, street, starts=(0, 0, 0))
    motions = fit_motions(pairs, FOCAL, SHAPE, PARAMS.model_copy(update={"pose_reach": 0}))
    assert _angle(motions[1], ACROSS) < 0.5


def test_pairs_farther_apart_than_the_reach_ask_the_next_ones(see, street, misled):
    misled(1)
    motions = fit_motions(_pairs(see, street, starts=(0, 8, 16)), FOCAL, SHAPE, PARAMS, step=8)
    assert _angle(motions[1], AHEAD) < 0.5


def test_known_motions_stay_and_are_asked(see, street, misled):
    pairs = _pairs(see, street)
    (known, *_) = fit_motions(pairs, FOCAL, SHAPE, PARAMS)
    misled(0)
    wrong = known._replace(translation=ACROSS)
    motions = fit_motions(pairs, FOCAL, SHAPE, PARAMS, known={0: known, 2: wrong})
    assert motions[0] is known
    assert motions[2] is wrong
    assert _angle(motions[1], AHEAD) < 0.5


def test_few_directions_are_tried_of_a_camera_at_rest(see, street, monkeypatch):
    rng, tried = np.random.default_rng(0), []
    pairs = [pair._replace(points1=pair.points0) for pair in _pairs(see, street, starts=range(9))]
    still = CameraMotion(np.eye(3), AHEAD, FOCAL * SHAPE[1])

    def random_direction(*_):
        direction = rng.normal(size=3)
        return still._replace(translation=direction / np.linalg.norm(direction))

    refine = camera_motions.refine_camera_motion
    monkeypatch.setattr(camera_motions, "fit_pose", random_direction)
    monkeypatch.setattr(camera_motions, "refine_camera_motion", lambda *a, **k: tried.append(a) or refine(*a, **k))
    assert len(fit_motions(pairs, FOCAL, SHAPE, PARAMS)) == 9
    assert len(tried) == 4 * len(pairs)


def test_a_camera_that_changes_its_direction_does(see, street):
    ahead, across = _pairs(see, street), _pairs(see, street, advance=ACROSS, yaw=0.0)
    motions = fit_motions([ahead[0], across[1], ahead[2]], FOCAL, SHAPE, PARAMS)
    assert _angle(motions[0], AHEAD) < 0.5
    assert _angle(motions[1], -ACROSS) < 0.5
    assert _angle(motions[2], AHEAD) < 0.5


def test_a_motion_that_puts_tracks_behind_infinity_explains_none(see, street, misled):
    misled(1)
    backwards = _pairs(see, street, advance=np.array([0.0, 0.0, -1.0]), yaw=0.0)
    motions = fit_motions([_pairs(see, street)[0], backwards[1]], FOCAL, SHAPE, PARAMS)
    # In the opposite direction all epipolar lines are the same.
    assert _angle(motions[1], AHEAD) > 45


@pytest.mark.parametrize("num_tracks", [0, 15])
def test_a_pair_of_few_tracks_has_no_motion(see, street, num_tracks):
    pairs = _pairs(see, street)
    pairs[1] = PairTracks(3, pairs[1].points0[:num_tracks], pairs[1].points1[:num_tracks])
    motions = fit_motions(pairs, FOCAL, SHAPE, PARAMS)
    assert motions[1] is None
    assert None not in (motions[0], motions[2])


def test_no_pairs_have_no_motions():
    assert fit_motions([], FOCAL, SHAPE, PARAMS) == []
