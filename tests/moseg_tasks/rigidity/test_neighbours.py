import numpy as np
import pytest
from pydantic import ValidationError

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.neighbours import Neighbours, find_similar
from moseg.tasks.rigidity.runs import expand_runs

PARAMS = RigidityParams()


def scattered(num_tracks=60):
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 100, (num_tracks, 2))
    moved = np.where(points[:, :1] < 50, [1.0, 0.0], [6.0, 2.0])
    return points, points + moved


def test_neighbours_move_alike_and_include_the_track_itself():
    points0, points1 = scattered()
    similar = find_similar(points0, points1, PARAMS)
    assert similar.index.shape == (60, PARAMS.neighbours)
    assert (similar.index == np.arange(60)[:, None]).any(axis=1).all()
    is_left = points0[:, 0] < 50
    alike = is_left[similar.index] == is_left[:, None]
    assert similar.weight[~alike].max(initial=0) < 1e-6


def test_fewer_tracks_than_neighbours_are_all_neighbours():
    points0, points1 = scattered(3)
    np.testing.assert_array_equal(np.sort(find_similar(points0, points1, PARAMS).index, axis=1), [[0, 1, 2]] * 3)
    assert find_similar(*scattered(1), PARAMS).index.tolist() == [[0]]


def test_as_many_neighbours_as_candidates_are_all_of_these_and_more_are_refused():
    similar = find_similar(*scattered(), RigidityParams(neighbours=30))
    assert similar.index.shape == (60, 30)
    with pytest.raises(ValidationError, match="neighbours of at most neighbour_candidates"):
        RigidityParams(neighbours=31)


def test_half_the_weight_lies_on_either_side_of_the_median():
    rng = np.random.default_rng(1)
    similar = Neighbours(rng.integers(40, size=(40, 9)), rng.uniform(0.01, 1, (40, 9)))
    values = rng.normal(size=40)
    middle = similar.median(values)[:, None]
    half = similar.weight.sum(axis=1) / 2
    near = values[similar.index]
    assert ((similar.weight * (near < middle)).sum(axis=1) < half).all()
    assert ((similar.weight * (near <= middle)).sum(axis=1) >= half).all()


def test_a_single_outlier_does_not_move_the_median():
    points0, points1 = scattered()
    values = np.zeros(60)
    values[7] = 100.0
    assert find_similar(points0, points1, PARAMS).median(values).max() == 0


def test_the_mean_of_equal_values_is_that_value():
    similar = find_similar(*scattered(), PARAMS)
    np.testing.assert_allclose(similar.mean_with_itself(np.full(60, 0.7)), 0.7)


def test_runs_are_listed_one_after_the_other():
    row, index = expand_runs(np.array([3, 5, 0, 9]), np.array([5, 5, 3, 8]))
    np.testing.assert_array_equal(row, [0, 0, 2, 2, 2])
    np.testing.assert_array_equal(index, [3, 4, 0, 1, 2])
