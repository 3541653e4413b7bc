import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from moseg.schemas.errors import InputError
from moseg.tasks.metrics import clustering_error

TRUTH = np.array([1, 1, 1, 1, 2, 2, 2, 3, 3, 3])
LABELS = arrays(np.int64, 12, elements=st.integers(0, 4))


@pytest.mark.parametrize(
    ("predicted", "error"),
    [
        ([7, 7, 7, 7, 0, 0, 0, 4, 4, 4], 0),
        ([1, 1, 1, 2, 2, 2, 2, 3, 3, 3], 10),
        ([5, 5, 5, 5, 5, 5, 5, 5, 5, 5], 60),
        ([1, 1, 4, 4, 2, 2, 2, 3, 3, 3], 20),
        ([0, 1, 2, 3, 4, 5, 6, 7, 8, 9], 70),
    ],
    ids=["renamed", "one wrong", "one group", "a motion in two", "all apart"],
)
def test_known_errors(predicted, error):
    assert clustering_error(np.array(predicted), TRUTH) == pytest.approx(error)


def test_matching_is_best_over_all_and_not_group_by_group():
    """The largest overlap (group 0 with label 1) must give way."""
    predicted, truth = np.repeat([0, 0, 1], [5, 4, 4]), np.repeat([1, 2, 1], [5, 4, 4])
    assert clustering_error(predicted, truth) == pytest.approx(100 * 5 / 13)


@given(LABELS, LABELS, st.permutations(range(5)), st.randoms())
def test_names_and_order_do_not_matter(predicted, truth, names, random):
    order = list(range(12))
    random.shuffle(order)
    error = clustering_error(predicted, truth)
    assert clustering_error(np.array(names)[predicted][order], truth[order]) == error
    assert clustering_error(truth, predicted) == error
    assert 0 <= error <= 100 * (1 - 1 / 12)


@pytest.mark.parametrize(("predicted", "truth"), [([], []), ([1], [1, 2]), ([[1]], [[1]])])
def test_there_must_be_something_to_compare(predicted, truth):
    with pytest.raises(InputError, match="nothing to compare"):
        clustering_error(np.array(predicted, int), np.array(truth, int))
