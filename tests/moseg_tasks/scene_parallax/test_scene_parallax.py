"""The source of proposals that the camera's motion chooses: tracks for a drive ahead, saliency for all else."""

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams, SceneParallaxParams
from moseg.tasks.rigidity.explained_shares import ExplainedShares
from moseg.tasks.scene_parallax import PairEvidence, choose_source, count_still, follow_corners, measure_pairs
from moseg.tasks.synthetic import SCENES, render_scene

PARAMS = SceneParallaxParams()
AHEAD = np.array([0.0, 0.0, -1.0])


def _evidence(gain=0.5, heading=AHEAD, sees_epipole=True):
    return PairEvidence(10.0, ExplainedShares(0.9, 0.9 - gain), np.array(heading), sees_epipole)


def _choose(evidence, num_pairs, params=PARAMS):
    """Return the choice where the camera stands still over all pairs without evidence."""
    return choose_source(evidence, num_pairs, num_pairs - len(evidence), params)


def _turned(degrees):
    angle = np.radians(degrees)
    return [np.sin(angle), 0.0, -np.cos(angle)]


@pytest.mark.parametrize(
    ("name", "source", "reason"),
    [
        ("pan", "saliency", "one plane"),
        ("forward-drive-epipolar-car", "tracks", "drives"),
        ("static-camera", "saliency", "stands still"),
        ("zoom", "saliency", "one plane"),
        ("strong-parallax", "saliency", "does not move ahead"),
    ],
)
def test_scenes_with_known_cameras(name, source, reason):
    images = render_scene(SCENES[name].model_copy(update={"num_frames": 9})).images
    pairs = [follow_corners(images[first : first + 5], PARAMS) for first in (0, 2, 4)]
    evidence = measure_pairs(pairs, images.shape[1:3], PARAMS, RigidityParams())
    chosen = choose_source(evidence, len(pairs), count_still(pairs, images.shape[1:3], PARAMS), PARAMS)
    assert chosen.proposals == source
    assert reason in chosen.reason


def test_a_track_is_where_its_corner_went():
    rng = np.random.default_rng(3)
    wide = np.repeat(rng.integers(0, 255, (30, 44, 1), np.uint8).repeat(4, 0).repeat(4, 1), 3, axis=2)
    points0, points1 = follow_corners([wide[:, 2 * step : 160 + 2 * step] for step in range(3)], PARAMS)
    assert len(points0) > 20
    np.testing.assert_allclose(np.median(points1 - points0, axis=0), [-4, 0], atol=0.1)


def test_frames_without_corners_are_no_evidence():
    pairs = [follow_corners([np.full((64, 96, 3), 90, np.uint8)] * 3, PARAMS)]
    assert measure_pairs(pairs, (64, 96), PARAMS, RigidityParams()) == []
    assert count_still(pairs, (64, 96), PARAMS) == 0
    chosen = choose_source([], 1, 0, PARAMS)
    assert (chosen.proposals, chosen.reason) == ("saliency", "too few corners to see the camera's motion")


@pytest.mark.parametrize(
    ("num_moving", "num_still", "reason"),
    [
        (0, 6, "the camera stands still"),
        (0, 4, "the camera stands still"),
        (0, 3, "too few corners to see the camera's motion"),
        (0, 0, "too few corners to see the camera's motion"),
        (2, 4, "the camera stands still most of the time"),
        (2, 3, "too few corners to see the camera's motion"),
        (3, 1, "the camera drives through a scene with depth"),
    ],
)
def test_a_camera_is_said_to_stand_still_only_where_it_is_seen_to(num_moving, num_still, reason):
    assert choose_source([_evidence()] * num_moving, 6, num_still, PARAMS).reason == reason


def test_of_the_pairs_with_enough_tracks_those_are_still_over_which_the_camera_does_not_move():
    still, moving = _corners(move=(0.5, 0.0)), _corners()
    few = tuple(points[: PARAMS.min_tracks - 1] for points in still)
    assert count_still([still, moving, few], (240, 320), PARAMS) == 1
    assert len(measure_pairs([still, moving, few], (240, 320), PARAMS, RigidityParams())) == 1


def _corners(at_rest=(), rest=(0.0, 0.0), move=(9.0, 3.0)):
    """Return a pair of the corners of frames of 240 x 320 px, of which those in some borders move by `rest`, px."""
    points = np.random.default_rng(4).uniform((0, 0), (319, 239), (400, 2))
    x, y = points.T
    borders = {"left": x < 36, "right": x > 283, "top": y < 36, "bottom": y > 203}
    rests = np.any([np.zeros(len(points), bool)] + [borders[side] for side in at_rest], axis=0)
    return points, points + np.where(rests[:, None], rest, move)


def _num_moving(pair, **params):
    return len(measure_pairs([pair], (240, 320), PARAMS.model_copy(update=params), RigidityParams()))


@pytest.mark.parametrize(
    ("at_rest", "rest", "moves"),
    [
        (("left", "right"), (0.1, 0.1), False),
        (("top", "bottom"), (0.1, 0.1), False),
        (("left", "right"), (0.2, 0.0), True),
        # The bonnet of the car in which the camera drives.
        (("bottom",), (0.0, 0.0), True),
        (("left", "top"), (0.0, 0.0), True),
        ((), (0.0, 0.0), True),
    ],
)
def test_a_camera_is_still_where_opposite_borders_are_at_rest_whatever_most_corners_do(at_rest, rest, moves):
    pair = _corners(at_rest, rest)
    assert np.median(np.linalg.norm(pair[1] - pair[0], axis=1)) > 9
    assert _num_moving(pair) == moves
    assert _num_moving(pair, rest_motion=0) == 1


def test_enough_of_the_corners_at_both_borders_must_be_at_rest():
    points0, points1 = _corners(("left", "right"))
    left = np.flatnonzero(points0[:, 0] < 36)
    points1[left[: round(0.65 * len(left))]] += 2
    assert _num_moving((points0, points1)) == 1
    assert _num_moving((points0, points1), rest_share=0.3) == 0


@pytest.mark.parametrize(("number", "moves"), [(4, True), (5, False)])
def test_a_border_with_hardly_any_corner_is_not_at_rest(number, moves):
    points0, points1 = _corners(("left", "right"))
    left = points0[:, 0] < 36
    kept = ~left | (np.cumsum(left) <= number)
    assert _num_moving((points0[kept], points1[kept])) == moves


def test_a_camera_is_still_where_most_corners_move_little():
    assert [_num_moving(_corners(move=(speed, 0.0))) for speed in (0.9, 1.1)] == [0, 1]


@pytest.mark.parametrize(
    ("evidence", "num_pairs", "source"),
    [
        ([_evidence()] * 4, 4, "tracks"),
        ([_evidence()] * 2, 6, "saliency"),
        ([_evidence(gain=0.1)] * 4, 4, "saliency"),
        ([_evidence(sees_epipole=False)] * 4, 4, "saliency"),
        ([_evidence(heading=_turned(angle)) for angle in (-12, -5, 5, 12)], 4, "saliency"),
        # A mounted camera may look aside, and one bad fit decides nothing.
        ([_evidence(heading=_turned(angle)) for angle in (14, 15, 15, 80)], 4, "tracks"),
    ],
)
def test_what_the_choice_asks_for(evidence, num_pairs, source):
    assert _choose(evidence, num_pairs).proposals == source


ASIDE = {"sees_epipole": False}


@pytest.mark.parametrize(
    ("evidence", "num_pairs", "shows"),
    [
        # Where the camera moves ahead, a little parallax shows depth.
        ([_evidence(gain=0.06)] * 4, 4, True),
        ([_evidence(gain=0.04)] * 4, 4, False),
        ([_evidence(gain=0.06)] * 2, 5, False),
        # Elsewhere it takes as much as tracks do.
        ([_evidence(gain=0.23, **ASIDE)] * 4, 4, True),
        ([_evidence(gain=0.21, **ASIDE)] * 4, 4, False),
        ([_evidence(gain=0.23, **ASIDE)] * 2, 5, False),
        ([_evidence(gain=0.21, heading=_turned(angle)) for angle in (-12, -5, 5, 12)], 4, False),
        ([_evidence(gain=0.23, heading=_turned(angle)) for angle in (-12, -5, 5, 12)], 4, True),
        ([], 4, False),
    ],
)
def test_where_depth_shows_by_parallax(evidence, num_pairs, shows):
    assert _choose(evidence, num_pairs).shows_depth is shows


def test_each_gain_has_its_own_threshold():
    ahead, aside = [_evidence(gain=0.3)] * 4, [_evidence(gain=0.3, **ASIDE)] * 4
    few, many = PARAMS.model_copy(update={"min_ahead_gain": 0.4}), PARAMS.model_copy(update={"min_gain": 0.4})
    assert [_choose(pairs, 4, few).shows_depth for pairs in (ahead, aside)] == [False, True]
    assert [_choose(pairs, 4, many).shows_depth for pairs in (ahead, aside)] == [True, False]
    assert _choose(ahead, 4, few).proposals == "tracks"
