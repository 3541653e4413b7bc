"""Laws of objects that lie apart."""

import numpy as np
import pytest

from moseg.schemas.parameters import EnergyParams, SeparationParams, TrajectoryClusteringParams
from moseg.tasks.trajectories.cluster import excess_price
from moseg.tasks.trajectories.separation import nearest_trajectories, separate_objects

PARAMS = SeparationParams(num_neighbours=4, min_tracks=8)


def _scene(*centres, size=12, spread=10.0, background=60):
    """A background over the whole image, and a cluster of trajectories at each centre; all drift alike."""
    rng = np.random.default_rng(0)
    start = [rng.uniform(0, 400, (background, 2))]
    start += [np.array(centre) + rng.uniform(-spread, spread, (size, 2)) for centre in centres]
    points = np.concatenate(start)[:, None] + np.arange(4)[None, :, None] * [3.0, 1.0]
    return points, np.ones(points.shape[:2], bool), background


def test_two_objects_of_one_motion_become_two_motions():
    points, visible, background = _scene((80, 80), (320, 320))
    labels = (np.arange(len(points)) >= background).astype(int)
    separated = separate_objects(points, visible, labels, PARAMS)
    assert [len(set(separated[part])) for part in (slice(60), slice(60, 72), slice(72, 84))] == [1, 1, 1]
    assert len(set(separated.tolist())) == 3


def test_one_object_stays_whole():
    points, visible, background = _scene((80, 80))
    labels = (np.arange(len(points)) >= background).astype(int)
    assert np.array_equal(separate_objects(points, visible, labels, PARAMS), labels)


def test_the_background_is_never_split():
    points, visible, background = _scene((80, 80), (320, 320))
    points[:30, :, 0] *= 0.1
    points[30:60, :, 0] = 380 + 0.1 * points[30:60, :, 0]
    labels = np.zeros(len(points), int)
    labels[background:] = 1
    separated = separate_objects(points, visible, labels, PARAMS)
    assert len(set(separated[:background].tolist())) == 1


@pytest.mark.parametrize(("size", "count"), [(7, 2), (8, 3)])
def test_a_few_strays_are_no_motion(size, count):
    points, visible, background = _scene((80, 80), (320, 320))
    kept = np.r_[: background + 12, background + 12 : background + 12 + size]
    labels = (kept >= background).astype(int)
    separated = separate_objects(points[kept], visible[kept], labels, PARAMS)
    assert len(set(separated.tolist())) == count


def test_a_trajectory_that_is_never_seen_keeps_its_label():
    points, visible, background = _scene((80, 80))
    visible[-1] = False
    labels = (np.arange(len(points)) >= background).astype(int)
    assert separate_objects(points, visible, labels, PARAMS)[-1] == 1


@pytest.mark.parametrize(("min_gap", "count"), [(1.0, 2), (0.0, 3)])
def test_near_parts_of_one_long_body_are_one_motion(min_gap, count):
    points, visible, background = _scene((200, 190), (200, 250), size=20)
    points[background:, :, 0] = 200 + 6 * (points[background:, :, 0] - 200)
    labels = (np.arange(len(points)) >= background).astype(int)
    separated = separate_objects(points, visible, labels, PARAMS.model_copy(update={"min_gap": min_gap}))
    assert len(set(separated.tolist())) == count


def test_parts_that_are_never_seen_together_are_separate():
    points, visible, background = _scene((80, 80), (320, 320))
    visible[background : background + 12, 2:] = False
    visible[background + 12 :, :2] = False
    labels = (np.arange(len(points)) >= background).astype(int)
    assert len(set(separate_objects(points, visible, labels, PARAMS).tolist())) == 3


def test_objects_apart_in_one_group_count_against_a_grouping():
    points, visible, background = _scene((80, 80), (320, 320), background=76)
    together = (np.arange(100) >= background).astype(int)
    apart = together + (np.arange(100) >= background + 12)
    params = TrajectoryClusteringParams(separation=PARAMS, energy=EnergyParams(motion_weight=0.3, chance_weight=2))
    penalty = excess_price(points, visible, params)
    assert penalty(apart) == penalty(5 - apart) == 0
    assert penalty(together) == pytest.approx(0.5)


def test_complete_trajectories_have_the_neighbours_of_almost_complete_ones():
    points, visible, _ = _scene((80, 80), (320, 320))
    complete = nearest_trajectories(points, visible, 4).toarray()
    # One more trajectory, far away and hidden in one frame, takes the other branch.
    far = np.concatenate([points, points[:1] + 1e4])
    hidden = np.concatenate([visible, [[True, True, True, False]]])
    assert np.array_equal(nearest_trajectories(far, hidden, 4).toarray()[:-1, :-1], complete)


def test_a_gap_is_compared_with_the_smaller_part():
    points, visible, background = _scene((100, 200), (250, 200), size=20)
    first = slice(background, background + 20)
    points[first, :, 0] = 100 + 8 * (points[first, :, 0] - 100)
    labels = (np.arange(len(points)) >= background).astype(int)
    assert len(set(separate_objects(points, visible, labels, PARAMS).tolist())) == 3


def test_the_background_is_the_largest_of_what_is_seen():
    points, visible, background = _scene((80, 80), (320, 320))
    points[-1, 2:], points[-2, 2:] = [[-5000, -5000], [5000, 9000]], [[5000, -9000], [-5000, 9000]]
    visible[-2:, 2:] = False
    labels = (np.arange(len(points)) >= background).astype(int)
    separated = separate_objects(points, visible, labels, PARAMS)
    assert len(set(separated[:background].tolist())) == 1 and len(set(separated[background:].tolist())) == 2


def test_neighbours_that_are_seldom_seen_together_are_no_nearer():
    points = np.repeat(np.array([[0.0, 0], [10, 0], [15, 0]])[:, None], 4, axis=1)
    visible = np.array([[True] * 4, [True] * 4, [True, False, False, False]])
    assert nearest_trajectories(points, visible, 1).toarray()[0].tolist() == [0, 1, 0]
