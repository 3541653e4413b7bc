"""Motion groups of a sample of tracks, in exact drives past two cars."""

from functools import cache
from typing import NamedTuple, get_args

import numpy as np
import pytest

from moseg.schemas.parameters import CandidateParams, HypothesisParams, RegroupParams, TrackGroupParams
from moseg.tasks.track_objects import group_tracks, moving_group, regroup_candidates

PARAMS = TrackGroupParams()
NUM_FRAMES, FOCAL = 8, 900.0
WIDTH, HEIGHT = 1242, 375
SPEEDS = ((-0.35, 0.0, 0.5), (0.35, 0.0, 1.6))
"""Motions of the cars per frame, m; the camera advances by 0.8."""


class Drive(NamedTuple):
    """Tracks (track, frame, xy) in px, their visibility, and the car of each; 0 = static."""

    points: np.ndarray
    visible: np.ndarray
    truth: np.ndarray


@cache
def drive(num_static=400, num_car=60):
    """Return the exact tracks of a static scene and of two cars side by side, one of which turns."""
    rng = np.random.default_rng(0)
    depth = rng.uniform(10, 60, num_static)
    static = np.stack([rng.uniform(-0.6, 0.6, num_static), rng.uniform(-0.18, 0.18, num_static)], axis=1)
    world = [np.column_stack([static * depth[:, None], depth])]
    world += [rng.uniform([x, 0, 14], [x + 1.6, 1.4, 17.5], (num_car, 3)) for x in (-0.2, 1.5)]
    truth = np.repeat(range(3), [len(part) for part in world])
    places = []
    for frame in range(NUM_FRAMES):
        moved = [world[0], *(part + np.array(speed) * frame for part, speed in zip(world[1:], SPEEDS, strict=True))]
        seen = np.concatenate(moved) - [0, 0, 0.8 * frame]
        places.append(FOCAL * seen[:, :2] / seen[:, 2:] + [WIDTH / 2, HEIGHT / 2])
    points = np.stack(places, axis=1).astype(np.float32)
    visible = ((points >= 0) & (points < [WIDTH, HEIGHT])).all(axis=2)
    return Drive(points, visible, truth)


def _group(scene, candidate, state=None, seed=0, **changes):
    state = np.where(candidate > 0, 3.0, -3.0) if state is None else state
    params = PARAMS.model_copy(update=changes)
    rng = np.random.default_rng(seed)
    return group_tracks(scene.points, scene.visible, state, candidate.astype(np.uint16), params, rng)


def test_two_cars_and_the_background_are_three_groups():
    scene = drive()
    groups = _group(scene, scene.truth > 0)
    assert (groups.track.dtype, groups.is_candidate.dtype, groups.motion.dtype) == (np.int32, np.bool_, np.uint16)
    truth = scene.truth[groups.track]
    np.testing.assert_array_equal(groups.is_candidate, truth > 0)
    main = [np.bincount(groups.motion[truth == label]).argmax() for label in range(3)]
    assert len({*main}) == 3
    assert np.mean(groups.motion == np.array(main)[truth]) > 0.95


@pytest.mark.parametrize("auto", get_args(type(PARAMS.clustering).model_fields["auto"].annotation))
def test_every_method_for_the_number_of_motions_counts_them_in_one_draw(auto):
    scene = drive()
    counted = PARAMS.clustering.model_copy(update={"auto": auto, "separate": False})
    assert 1 <= len({*_group(scene, scene.truth > 0, clustering=counted).motion}) <= counted.most_motions


def test_one_candidate_of_two_cars_and_some_background_becomes_two_objects():
    scene = drive()
    cars = scene.points[scene.truth > 0, 0]
    lower, upper = cars.min(axis=0) - 15, cars.max(axis=0) + 15
    around = ((scene.points[:, 0] >= lower) & (scene.points[:, 0] <= upper)).all(axis=1)
    assert 5 <= np.count_nonzero(around & (scene.truth == 0)) < 40
    candidate = around.astype(np.uint16)
    join, params = CandidateParams(), RegroupParams()
    found = moving_group(regroup_candidates(*scene[:2], candidate, [_group(scene, candidate)], join, params))
    assert found.max() == 1
    static = found[around & (scene.truth == 0)]
    assert np.mean(static == -1) > 0.8
    objects = [np.bincount(found[scene.truth == label] + 1).argmax() - 1 for label in (1, 2)]
    assert sorted(objects) == [0, 1]
    for label, number in zip((1, 2), objects, strict=True):
        assert np.mean(found[scene.truth == label] == number) > 0.9


@pytest.mark.parametrize(
    "changes", [{"min_moving": 121}, {"min_static": 121}, {"min_static_life": 9}, {"min_moving_life": 9}]
)
def test_too_few_tracks_of_a_kind_are_not_grouped(changes):
    scene = drive()
    enough = {"min_moving": 120, "min_static": 40}
    assert len(_group(scene, scene.truth > 0, **enough).track)
    nothing = _group(scene, scene.truth > 0, **enough | changes)
    assert [(values.dtype, len(values)) for values in nothing] == [(np.int32, 0), (np.bool_, 0), (np.uint16, 0)]


def test_without_tracks_there_are_no_groups():
    scene = Drive(np.zeros((0, 5, 2), np.float32), np.zeros((0, 5), bool), np.zeros(0, int))
    assert len(_group(scene, scene.truth).track) == 0


def test_static_tracks_are_spread_over_the_frame():
    scene = drive()
    groups = _group(scene, scene.truth > 0, cell=100)
    static = groups.track[~groups.is_candidate]
    first = scene.visible[static].argmax(axis=1)
    cells = scene.points[static, first].astype(int) // 100
    assert len(np.unique(cells, axis=0)) == len(static) > 30


def test_only_tracks_that_are_surely_static_are_sampled_as_static():
    scene = drive()
    state = np.where(scene.truth > 0, 3.0, -3.0)
    doubtful = np.flatnonzero(scene.truth == 0)[::2]
    state[doubtful] = -0.5
    candidate = scene.truth == 1
    groups = _group(scene, candidate, state)
    assert not np.isin(groups.track, doubtful).any()
    # The other car is no candidate and not static either.
    assert (scene.truth[groups.track] < 2).all()
    assert len(_group(scene, candidate, state, max_static_state=0.0).track) > len(groups.track)


def test_samples_are_no_larger_than_asked_for_and_favour_small_candidates():
    scene = drive()
    small = np.flatnonzero(scene.truth == 2)[:12]
    candidate = np.where(scene.truth == 1, 1, 0)
    candidate[small] = 2
    groups = _group(scene, candidate, max_moving=36, max_static=15)
    sampled = groups.track[groups.is_candidate]
    assert (len(sampled), np.count_nonzero(~groups.is_candidate)) == (36, 15)
    assert len({*groups.track.tolist()}) == 51
    shares = [np.isin(_sampled(scene, candidate, seed), small).mean() for seed in range(4)]
    assert np.mean(shares) > 12 / 72 + 0.05


def _sampled(scene, candidate, seed):
    quick = {"models": ("homography",), "hypotheses": HypothesisParams(num_hypotheses=10, num_draws=1)}
    groups = _group(scene, candidate, seed=seed, max_moving=24, max_static=15, **quick)
    return groups.track[groups.is_candidate]


def test_the_groups_are_the_same_each_time_and_hidden_places_are_not_read():
    scene = drive()
    expected = _group(scene, scene.truth > 0)
    points = np.where(scene.visible[..., None], scene.points, np.nan)
    for found in (_group(scene, scene.truth > 0), _group(scene._replace(points=points), scene.truth > 0)):
        np.testing.assert_equal(tuple(found), tuple(expected))
