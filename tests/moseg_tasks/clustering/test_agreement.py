"""Static by agreement of the views."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import ClusteringParams
from moseg.tasks.clustering import agreed_static, cluster_motions

EVERY = [
    ClusteringParams(fusion=fusion, grouping=grouping, auto=auto)
    for fusion, grouping, auto in itertools.product(
        ["product", "sum", "coregularised"], ["linkage", "spectral"], ["threshold", "eigengap"]
    )
]


def test_an_object_is_static_if_every_view_agrees():
    blind, sees = np.array([1.0, 0.9, 0.9, 0.9]), np.array([1.0, 0.8, 0.1, np.nan])
    assert agreed_static([blind, sees], 0.5).tolist() == [True, True, False, False]
    assert agreed_static([sees, blind], 0.5).tolist() == [True, True, False, False]
    assert agreed_static([blind], 0.5).all()


def test_the_background_is_always_static():
    assert agreed_static([np.array([np.nan, 0.1])], 0.5).tolist() == [True, False]


def test_a_speck_that_no_view_could_measure_is_static_and_one_that_a_view_sees_move_is_not():
    unknown = np.array([1.0, np.nan, np.nan, np.nan])
    assert agreed_static([unknown, np.array([1.0, np.nan, 0.1, 0.9])], 0.5).tolist() == [True, True, False, False]
    assert agreed_static([unknown], 0.5).all()


def test_the_threshold_is_the_minimal_support_of_agreement():
    support = np.array([1.0, 0.5, 0.49])
    assert agreed_static([support], 0.5).tolist() == [True, True, False]


def test_a_known_rigid_support_decides_alone_and_an_open_one_leaves_it_to_the_views():
    blind, sees = np.array([1.0, 0.9, 0.9, 0.9, 0.9, np.nan]), np.array([1.0, 0.1, 0.9, 0.9, 0.1, np.nan])
    rigid = np.array([1.0, 1.0, 0.0, np.nan, np.nan, 0.0])
    assert agreed_static([blind, sees], 0.5, rigid).tolist() == [True, True, False, True, False, False]
    assert agreed_static([blind, sees], 0.5, np.full(6, np.nan)).tolist() == agreed_static([blind, sees], 0.5).tolist()


def test_the_background_is_static_and_the_threshold_holds_for_the_rigid_support_too():
    support = np.array([1.0, 0.1, 0.9])
    assert agreed_static([support], 0.5, np.array([0.0, 0.5, 0.49])).tolist() == [True, True, False]


def _movers():
    """Return affinities of the background, three pairs of movers and a static object; pairs 1 and 2 are a bit alike."""
    affinity = np.full((8, 8), 0.02)
    affinity[np.ix_((1, 2, 3, 4), (1, 2, 3, 4))] = 0.3
    for group in ((1, 2), (3, 4), (5, 6)):
        affinity[np.ix_(group, group)] = 0.95
    affinity[0] = affinity[:, 0] = 0.97
    np.fill_diagonal(affinity, 1.0)
    return affinity, np.array([True, *[False] * 6, True])


@pytest.mark.parametrize("params", EVERY)
def test_movers_are_grouped_into_the_given_number_less_one(params):
    affinity, is_static = _movers()
    for number, expected in ((4, [0, 1, 1, 2, 2, 3, 3, 0]), (3, [0, 1, 1, 1, 1, 2, 2, 0]), (2, [0, *[1] * 6, 0])):
        result = cluster_motions([affinity, affinity], number, params, is_static)
        assert (result.motion.tolist(), result.num_motions) == (expected, number)


@pytest.mark.parametrize("params", EVERY)
def test_fewer_movers_than_the_given_number_have_a_motion_each(params):
    affinity, _ = _movers()
    is_static = np.array([True, True, False, False, True, True, True, True])
    for number in (3, 4, 20):
        result = cluster_motions([affinity, affinity], number, params, is_static)
        assert (result.motion.tolist(), result.num_motions) == ([0, 0, 1, 2, 0, 0, 0, 0], 3)
    assert not cluster_motions([affinity], 5, params, np.ones(8, bool)).motion.any()


@pytest.mark.parametrize("params", EVERY)
def test_of_one_motion_everything_is_static(params):
    affinity, is_static = _movers()
    result = cluster_motions([affinity, affinity], 1, params, is_static)
    assert (result.motion.any(), result.num_motions) == (False, 1)


@settings(max_examples=80, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    params=st.sampled_from(EVERY),
    size=st.integers(1, 8),
    num_views=st.integers(1, 2),
    share_known=st.sampled_from([0.3, 1.0]),
)
def test_agreement_overrides_the_affinities(seed, params, size, num_views, share_known):
    rng = np.random.default_rng(seed)
    views = []
    for _ in range(num_views):
        view = rng.random((size, size)) ** rng.choice([0.1, 1.0, 10.0])
        view = np.where(rng.random((size, size)) < share_known, view, np.nan)
        view = np.where(np.isnan(view) | np.isnan(view.T), np.nan, (view + view.T) / 2)
        np.fill_diagonal(view, 1.0)
        views.append(view)
    is_static = rng.random(size) < 0.4
    is_static[0] = True
    motion = cluster_motions(views, None, params, is_static).motion
    assert np.array_equal(motion == 0, is_static)
    assert sorted(set(motion.tolist())) == list(range(motion.max() + 1))
    order = np.concatenate([[0], 1 + rng.permutation(size - 1)]).astype(int)
    shuffled = cluster_motions([v[np.ix_(order, order)] for v in views], None, params, is_static[order]).motion
    assert np.array_equal(shuffled == 0, is_static[order])


@pytest.mark.parametrize("params", EVERY)
def test_moving_objects_are_grouped_by_their_affinities_though_all_are_like_the_background(params):
    affinity = np.full((6, 6), 0.02)
    affinity[0] = affinity[:, 0] = 0.95
    for group in ((1, 2), (3, 4)):
        affinity[np.ix_(group, group)] = 0.95
    np.fill_diagonal(affinity, 1.0)
    is_static = np.array([True, False, False, False, False, True])
    motion = cluster_motions([affinity, affinity], None, params, is_static).motion
    assert motion.tolist() == [0, 1, 1, 2, 2, 0]
    assert not cluster_motions([np.ones((6, 6))], None, params).motion.any()


def test_an_object_of_unknown_affinities_moves_unless_it_is_given_as_static():
    unknown = np.full((2, 2), np.nan)
    assert cluster_motions([unknown], None, EVERY[0], np.array([True, False])).motion.tolist() == [0, 1]
    assert cluster_motions([unknown], None, EVERY[0]).motion.tolist() == [0, 0]


def test_bad_use_is_named():
    for is_static in ([True], [False, True]):
        with pytest.raises(InputError, match="not the static objects"):
            cluster_motions([np.eye(2)], None, EVERY[0], np.array(is_static))
