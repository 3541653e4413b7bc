"""Grouping objects by motion."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import AffinityParams, ClusteringParams
from moseg.tasks.affinity import estimate_affinity
from moseg.tasks.clustering import cluster_motions
from moseg.tasks.clustering.fusion import fuse_kernels
from moseg.tasks.clustering.linkage import link_objects

DEFAULT = ClusteringParams()
PAPER = ClusteringParams(fusion="coregularised", grouping="spectral")
EVERY = [
    ClusteringParams(fusion=fusion, grouping=grouping, auto=auto)
    for fusion, grouping, auto in itertools.product(
        ["product", "sum", "coregularised"], ["linkage", "spectral"], ["threshold", "eigengap"]
    )
]


def blocks(sizes, inside=0.95, outside=0.02, noise=0.02, seed=0) -> tuple[np.ndarray, np.ndarray]:
    """Affinity of objects in groups of the given sizes, and the true groups; object 0 is in the first."""
    rng = np.random.default_rng(seed)
    groups = np.repeat(np.arange(len(sizes)), sizes)
    affinity = np.where(groups[:, None] == groups[None, :], inside, outside) + noise * rng.random((sum(sizes),) * 2)
    affinity = np.minimum((affinity + affinity.T) / 2, 1.0)
    np.fill_diagonal(affinity, 1.0)
    return affinity, groups


def partition(labels) -> set[frozenset]:
    return {frozenset(np.flatnonzero(labels == label).tolist()) for label in np.unique(labels)}


def motion_residuals(sizes, num_pairs=10, seed=0) -> tuple[np.ndarray, np.ndarray]:
    """Residuals, px², of exact models in slight noise: 0.05 px inside a motion, pixels across; objects shuffled."""
    rng = np.random.default_rng(seed)
    groups = np.repeat(np.arange(len(sizes)), sizes)
    groups[1:] = rng.permutation(groups[1:])
    distance = rng.uniform(1.5, 6.0, (len(sizes),) * 2)[groups][:, groups]
    size = np.where(groups[:, None] == groups[None, :], 0.05, distance)
    return (size * rng.uniform(0.7, 1.3, (num_pairs, *size.shape))) ** 2, groups


@pytest.mark.parametrize("params", EVERY)
@pytest.mark.parametrize("num_motions", [None, 3])
def test_clear_groups_are_found(params, num_motions):
    (first, groups), (second, _) = blocks((4, 2, 3)), blocks((4, 2, 3), seed=1)
    result = cluster_motions([first, second], num_motions, params)
    assert result.num_motions == 3
    assert partition(result.motion) == partition(groups)
    assert result.motion[0] == 0 and result.motion.dtype == np.uint16
    assert sorted(set(result.motion.tolist())) == [0, 1, 2]


@pytest.mark.parametrize("params", EVERY)
def test_the_background_alone_is_static(params):
    for affinity in (np.ones((1, 1)), np.full((1, 1), np.nan)):
        for num_motions in (None, 1, 5):
            result = cluster_motions([affinity], num_motions, params)
            assert result.motion.tolist() == [0] and result.num_motions == 1


@pytest.mark.parametrize("grouping", ["linkage", "spectral"])
def test_a_single_object_moves_or_not(grouping):
    params = ClusteringParams(grouping=grouping)
    for affinity, moves in ((0.9, 0), (0.1, 1)):
        matrix = np.array([[1.0, affinity], [affinity, 1.0]])
        assert cluster_motions([matrix], None, params).motion.tolist() == [0, moves]
        assert cluster_motions([matrix], 2, params).motion.tolist() == [0, 1]
        assert cluster_motions([matrix], 1, params).motion.tolist() == [0, 0]
        assert cluster_motions([matrix], 7, params).motion.tolist() == [0, 1]


@pytest.mark.parametrize("params", EVERY)
def test_nothing_moves_if_all_are_alike(params):
    affinity, _ = blocks((6,))
    assert cluster_motions([affinity], None, params).num_motions == 1
    assert not cluster_motions([affinity], 1, params).motion.any()


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("num_motions", [None, 3])
def test_lone_movers_beside_a_large_background_are_found_by_residual_size(seed, num_motions):
    residuals, groups = motion_residuals((6, 1, 1), seed=seed)
    affinity = estimate_affinity(residuals, AffinityParams())
    assert partition(cluster_motions([affinity], num_motions, DEFAULT).motion) == partition(groups)


@pytest.mark.parametrize("reading", ["models", "objects"])
def test_ranks_fail_on_lone_movers_more_often_than_not(reading):
    params = AffinityParams(method="ork", ork_threshold=3, ork_reading=reading)
    failed = 0
    for seed in range(8):
        residuals, groups = motion_residuals((6, 1, 1), seed=seed)
        motion = cluster_motions([estimate_affinity(residuals, params)], 3, PAPER).motion
        failed += partition(motion) != partition(groups)
    assert failed >= 4


@pytest.mark.parametrize("reading", ["models", "objects"])
def test_ranks_succeed_where_every_motion_has_several_objects(reading):
    params = AffinityParams(method="ork", ork_threshold=3, ork_reading=reading)
    residuals, groups = motion_residuals((3, 3, 3))
    motion = cluster_motions([estimate_affinity(residuals, params)], 3, PAPER).motion
    assert partition(motion) == partition(groups)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    params=st.sampled_from(EVERY),
    num_motions=st.sampled_from([None, 2, 3]),
    size=st.integers(2, 8),
    contrast=st.sampled_from([0.0, 1e-3, 1.0]),
)
def test_the_order_of_objects_has_no_effect(seed, params, num_motions, size, contrast):
    # The smaller the contrast, the nearer to the identity, whose eigenvectors are the order of the objects.
    rng = np.random.default_rng(seed)
    views = []
    for _ in range(2):
        noise = contrast * rng.random((size, size)) if contrast else 1e-6 * rng.random((size, size))
        view = (noise + noise.T) / 2
        np.fill_diagonal(view, 1.0)
        views.append(view)
    order = np.concatenate([[0], 1 + rng.permutation(size - 1)])
    motion = cluster_motions(views, num_motions, params).motion
    shuffled = cluster_motions([view[np.ix_(order, order)] for view in views], num_motions, params).motion
    assert partition(shuffled) == partition(motion[order])


@pytest.mark.parametrize("num_motions", [2, 3, 4])
def test_objects_of_equal_affinities_all_move(num_motions):
    motion = cluster_motions([np.eye(5)], num_motions, DEFAULT).motion
    assert motion[0] == 0 and (motion[1:] > 0).all()
    assert motion.max() == num_motions - 1


def test_values_unknown_to_one_view_are_those_of_the_other():
    known, groups = blocks((3, 2))
    blind = np.full_like(known, np.nan)
    blind[:3, :3] = known[:3, :3]
    for fusion in ("product", "sum", "coregularised"):
        motion = cluster_motions([blind, known], None, ClusteringParams(fusion=fusion)).motion
        assert partition(motion) == partition(groups)


def test_objects_that_never_met_are_compared_through_others():
    affinity, _ = blocks((5, 1))
    affinity[1, 2] = affinity[2, 1] = np.nan  # both are like the background
    affinity[1, 5] = affinity[5, 1] = np.nan  # only one is
    assert cluster_motions([affinity], None, DEFAULT).motion.tolist() == [0, 0, 0, 0, 0, 1]
    assert cluster_motions([affinity], 2, PAPER).motion.tolist() == [0, 0, 0, 0, 0, 1]


def test_an_object_without_known_affinities_is_static():
    affinity, _ = blocks((2, 1))
    unknown = np.full((4, 4), np.nan)
    unknown[:3, :3] = affinity
    assert cluster_motions([unknown], None, DEFAULT).motion.tolist() == [0, 0, 1, 0]


def test_a_view_that_sees_two_motions_outweighs_one_that_is_blind():
    blind, sees = np.ones((2, 2)), np.array([[1.0, 1e-3], [1e-3, 1.0]])
    assert cluster_motions([blind, sees], None, DEFAULT).num_motions == 2
    assert cluster_motions([blind, np.sqrt(sees)], None, DEFAULT).num_motions == 2
    assert cluster_motions([blind, blind], None, DEFAULT).num_motions == 1


def test_result_describes_the_clustered_kernels():
    (first, _), (second, _) = blocks((4, 2)), blocks((4, 2), seed=1)
    one, two = (cluster_motions([first, second], 2, params) for params in (DEFAULT, PAPER))
    assert one.eigenvalues.shape == (1, 6) and two.eigenvalues.shape == (2, 6)
    assert one.embedding.shape == (6, 2) and two.embedding.shape == (6, 4)
    np.testing.assert_allclose(one.eigenvalues[:, 0], 1.0)
    assert (np.diff(two.eigenvalues, axis=1) <= 0).all()


def test_bad_use_is_named():
    with pytest.raises(InputError, match="no view to cluster"):
        cluster_motions([], None, DEFAULT)
    with pytest.raises(InputError, match="wrong shape of affinities"):
        cluster_motions([np.eye(3), np.eye(4)], None, DEFAULT)
    with pytest.raises(InputError, match="too few motions in cluster_motions; got 0"):
        cluster_motions([np.eye(3)], 0, DEFAULT)


def test_forty_objects_are_no_burden():
    affinity, groups = blocks((25, 10, 5))
    for params in (DEFAULT, PAPER):
        assert partition(cluster_motions([affinity, affinity], 3, params).motion) == partition(groups)


def test_what_is_like_the_background_joins_it_though_small_static_objects_differ():
    affinity = np.array([[1.0, 0.9, 0.8], [0.9, 1.0, 0.0], [0.8, 0.0, 1.0]])
    assert link_objects(affinity, threshold=0.5).tolist() == [0, 0, 0]


@pytest.mark.parametrize("fusion", ["product", "sum"])
@pytest.mark.parametrize("num_views", [1, 2, 3])
def test_views_that_agree_are_fused_to_what_they_are(fusion, num_views):
    view = np.array([[1.0, 0.3], [0.3, 1.0]])
    np.testing.assert_allclose(fuse_kernels(np.stack([view] * num_views), fusion), view)
