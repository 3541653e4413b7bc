"""Laws of the geometric cost of a grouping."""

import numpy as np
import pytest

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.trajectories.epipolar_cost import EpipolarCost

PARAMS = EnergyParams(gaps=(3,), spacing=0.3)
TRUE = np.repeat([0, 1], [60, 40])
ONE = np.zeros(100, int)


@pytest.fixture(scope="module")
def clip(rigid_clip):
    return rigid_clip((60, 40))


def _cost(clip, labelings, params=PARAMS):
    return EpipolarCost(clip.points, clip.visible, params).of_labelings(labelings)


def test_the_cost_of_rigid_groups_without_noise_is_zero(rigid_clip):
    exact = rigid_clip((60, 40), noise=0)
    assert _cost(exact, [TRUE])[0] < 1e-9


def test_the_true_grouping_costs_less_than_any_other(clip):
    rng = np.random.default_rng(0)
    halves = np.arange(len(TRUE)) % 2
    costs = _cost(clip, [TRUE, ONE, halves, rng.permutation(TRUE)])
    assert costs[0] < 0.1 and (costs[1:] > 2 * costs[0]).all()


def test_costs_do_not_depend_on_names_order_or_company(clip):
    order = np.random.default_rng(1).permutation(len(TRUE))
    shuffled = EpipolarCost(clip.points[order], clip.visible[order], PARAMS)
    together = _cost(clip, [TRUE, ONE, 7 - TRUE])
    assert together[0] == pytest.approx(together[2], rel=1e-9)
    assert together[0] == pytest.approx(_cost(clip, [TRUE])[0], rel=1e-9)
    assert shuffled.of_labelings([TRUE[order]])[0] == pytest.approx(together[0], rel=1e-6)


def test_the_unit_of_length_is_the_thresholds(clip):
    larger = clip._replace(points=3 * clip.points + [100, -50])
    scaled = _cost(larger, [TRUE, ONE], PARAMS.model_copy(update={"threshold": 3 * PARAMS.threshold}))
    np.testing.assert_allclose(scaled, _cost(clip, [TRUE, ONE]), rtol=1e-6)


def test_the_cost_of_seven_points_is_zero(clip):
    labels = np.zeros(len(TRUE), int)
    labels[::15] = 1  # seven trajectories of both motions
    few = np.count_nonzero(labels)
    assert few == 7
    kept = clip._replace(points=clip.points[labels == 1], visible=clip.visible[labels == 1])
    assert _cost(kept, [np.zeros(few, int)]).tolist() == [0.0]


def test_a_few_outliers_cost_little_more_than_themselves(rigid_clip):
    exact = rigid_clip((60,), noise=0.05, hidden=0)
    points = exact.points.copy()
    points[:6] += np.random.default_rng(2).uniform(-6, 6, points[:6].shape)
    alone = _cost(exact, [exact.labels])[0]
    assert _cost(exact._replace(points=points), [exact.labels])[0] < alone + 0.15


def test_a_clip_shorter_than_the_gap_is_judged_by_its_ends(clip):
    short = clip._replace(points=clip.points[:, :3], visible=clip.visible[:, :3])
    costs = _cost(short, [TRUE, ONE], PARAMS.model_copy(update={"gaps": (5, 9)}))
    assert 0 < costs[0] < costs[1]
    assert costs.tolist() == _cost(short, [TRUE, ONE], PARAMS.model_copy(update={"gaps": (2,)})).tolist()


def test_all_gaps_count_by_their_observations(rigid_clip):
    clip = rigid_clip((60, 40), hidden=0)
    num_frames = clip.points.shape[1]
    short, long, both = (
        _cost(clip, [TRUE, ONE], PARAMS.model_copy(update={"gaps": gaps, "spacing": 1 / 6}))
        for gaps in ((3,), (6,), (6, 3))
    )
    num_short, num_long = num_frames - 3, num_frames - 6
    np.testing.assert_allclose(both, (num_short * short + num_long * long) / (num_short + num_long), rtol=1e-9)


def test_a_gap_that_few_trajectories_span_is_not_read(rigid_clip):
    clip = rigid_clip((60, 40), hidden=0)
    starts = np.arange(100)[:, None] % 4
    short = clip._replace(visible=(np.arange(8) >= starts) & (np.arange(8) < starts + 5))
    near, both, always = (
        _cost(short, [TRUE, ONE], PARAMS.model_copy(update=update)).tolist()
        for update in ({"gaps": (2,)}, {"gaps": (2, 4)}, {"gaps": (2, 4), "min_spanning": 0.0})
    )
    assert near == both != always
    assert _cost(short, [TRUE, ONE], PARAMS.model_copy(update={"gaps": (4,)})).any()


def test_frames_farther_apart_show_slow_motion():
    rng = np.random.default_rng(3)
    angles, frames = rng.uniform(0, 2 * np.pi, (100, 1)), np.arange(8)
    drift = 0.1 * frames[None, :, None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    points = rng.uniform(0, 300, (100, 1, 2)) + drift + rng.normal(0, 0.02, (100, 8, 2))
    near, far = (
        EpipolarCost(points, np.ones((100, 8), bool), PARAMS.model_copy(update={"gaps": gaps})).of_labelings([ONE])[0]
        for gaps in ((3,), (3, 7))
    )
    assert far > 1.5 * near


def test_pairs_start_as_far_apart_as_a_share_of_their_gap(rigid_clip):
    clip = rigid_clip((60, 40), hidden=0)
    params = PARAMS.model_copy(update={"gaps": (4,), "spacing": 1.0})
    points = clip.points.copy()
    read = np.arange(0, points.shape[1], 4)
    unread = np.setdiff1d(np.arange(points.shape[1]), read)
    points[:, unread] += np.random.default_rng(4).normal(0, 20, points[:, unread].shape)
    assert _cost(clip._replace(points=points), [TRUE], params) == _cost(clip, [TRUE], params)


def test_the_cost_of_coincident_points_is_zero():
    points, visible = np.full((20, 5, 2), 100.0), np.ones((20, 5), bool)
    assert EpipolarCost(points, visible, PARAMS).of_labelings([np.zeros(20, int)]).tolist() == [0.0]


def test_thorough_fits_never_cost_more_and_do_not_depend_on_company(clip):
    halves = np.arange(len(TRUE)) % 2
    cost = EpipolarCost(clip.points, clip.visible, PARAMS)
    costs, thorough = cost.of_labelings([TRUE, ONE, halves]), cost.of_labelings_thoroughly([TRUE, ONE, halves], [])
    assert (thorough <= costs).all()
    again = EpipolarCost(clip.points, clip.visible, PARAMS).of_labelings_thoroughly([ONE, halves], [TRUE])
    np.testing.assert_allclose(again, thorough[1:], rtol=1e-9)


def test_a_union_is_fitted_as_well_as_its_larger_part_explains_it(rigid_clip):
    clip = rigid_clip((60, 40), hidden=0)
    cost = EpipolarCost(clip.points, clip.visible, PARAMS)
    of_larger_part = cost.of_trajectories(TRUE)[:, 0].sum()
    assert cost.of_labelings([ONE])[0] > of_larger_part
    assert cost.of_labelings_thoroughly([ONE], [TRUE])[0] <= of_larger_part


def test_groups_too_small_for_a_matrix_cost_nothing_thoroughly_either(clip):
    few = np.where(np.arange(len(TRUE)) < 5, 2, TRUE)
    cost = EpipolarCost(clip.points, clip.visible, PARAMS)
    costs = cost.of_labelings([few])
    assert 0 <= cost.of_labelings_thoroughly([few], [ONE])[0] <= costs[0]
