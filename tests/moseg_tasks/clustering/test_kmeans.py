"""k-means of objects' spectral coordinates."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.clustering.kmeans import MAX_EXACT, cluster_points


def inertia(points, labels) -> float:
    clusters = [points[labels == label] for label in np.unique(labels)]
    return float(sum(((cluster - cluster.mean(axis=0)) ** 2).sum() for cluster in clusters))


def test_the_optimum_that_farthest_first_starts_miss():
    points = np.array([[-1.0, -3.0], [4.0, -1.0], [0.0, 3.0], [-2.0, -2.0]])
    labels = cluster_points(points, 2)
    assert labels.tolist() == [0, 1, 1, 0]
    assert inertia(points, labels) == pytest.approx(17.0)


@settings(max_examples=60, deadline=None)
@given(
    points=st.lists(st.tuples(st.integers(-4, 4), st.integers(-4, 4)), min_size=1, max_size=6),
    num_clusters=st.integers(1, 4),
)
def test_no_labeling_of_few_points_is_tighter(points, num_clusters):
    points, num_clusters = np.array(points, dtype=np.float64), min(num_clusters, len(points))
    labels = cluster_points(points, num_clusters)
    every = itertools.product(range(num_clusters), repeat=len(points))
    assert inertia(points, labels) == pytest.approx(min(inertia(points, np.array(each)) for each in every))
    assert set(labels.tolist()) == set(range(labels.max() + 1)) and labels.max() < num_clusters


@pytest.mark.parametrize("num_points", [MAX_EXACT, MAX_EXACT + 1, 40])
def test_separate_groups_are_found(num_points):
    truth = np.arange(num_points) % 4
    points = np.array([[0, 0], [0, 9], [9, 0], [9, 9.5]])[truth] + np.random.default_rng(1).random((num_points, 2))
    np.testing.assert_array_equal(cluster_points(points, 4), truth)


@pytest.mark.parametrize("num_points", [4, MAX_EXACT, MAX_EXACT + 3])
def test_points_that_coincide_share_a_label(num_points):
    assert set(cluster_points(np.ones((num_points, 2)), 3).tolist()) == {0}
    two = np.repeat([[0.0, 1.0], [1.0, 0.0]], [num_points - 2, 2], axis=0)
    assert cluster_points(two, 3).tolist() == [0] * (num_points - 2) + [1] * 2


def test_many_points_are_clustered_the_same_way_every_time():
    points = np.random.default_rng(5).normal(size=(30, 3))
    np.testing.assert_array_equal(cluster_points(points, 5), cluster_points(points, 5))
