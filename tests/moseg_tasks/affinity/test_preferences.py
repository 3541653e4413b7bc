"""The kernel over preferred hypotheses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.tasks.affinity import preference_kernel


def test_shared_preferences_by_hand():
    residuals = np.array([[[1, 1, 9], [2, 8, 8], [8, 2, 2], [9, 9, 1]]], dtype=float)
    # Of four hypotheses the nodes prefer {0, 1}, {0, 2} and {2, 3}.
    expected = [[1, 0.5, 0], [0.5, 1, 0.5], [0, 0.5, 1]]
    np.testing.assert_allclose(preference_kernel(residuals, 0.5, 0.0), expected)


def test_equal_residuals_share_the_places_that_are_left_by_hand():
    residuals = np.array([[[1, 1], [2, 2], [2, 3], [3, 4]]], dtype=float)
    # Preferences (1, 0.5, 0.5, 0) and (1, 1, 0, 0).
    np.testing.assert_allclose(preference_kernel(residuals, 0.5, 0.0)[0, 1], 1.5 / np.sqrt(1.5 * 2))


@given(seed=st.integers(0, 99), power=st.floats(0.3, 3), factor=st.floats(0.1, 10))
def test_only_the_order_of_each_nodes_residuals_counts(seed, power, factor):
    residuals = np.random.default_rng(seed).random((3, 20, 5))
    changed = residuals.copy()
    changed[..., 2] = factor * changed[..., 2] ** power
    np.testing.assert_allclose(preference_kernel(changed, 0.2, 0.0), preference_kernel(residuals, 0.2, 0.0))


@given(seed=st.integers(0, 99))
def test_orders_of_hypotheses_and_objects_have_no_effect_even_among_equal_residuals(seed):
    rng = np.random.default_rng(seed)
    residuals = rng.integers(0, 4, (3, 20, 5)).astype(float)
    hypotheses, nodes = rng.permutation(20), rng.permutation(5)
    expected = preference_kernel(residuals, 0.2, 0.0)[np.ix_(nodes, nodes)]
    np.testing.assert_allclose(preference_kernel(residuals[:, hypotheses][..., nodes], 0.2, 0.0), expected)


def test_below_the_noise_nothing_is_preferred():
    residuals = np.random.default_rng(0).random((2, 50, 4)) * 0.09**2
    assert preference_kernel(residuals, 0.1, 0.0)[0, 1] < 0.5
    np.testing.assert_allclose(preference_kernel(residuals, 0.1, 0.09), np.ones((4, 4)))


def test_absent_nodes_take_no_part_in_a_pair():
    residuals = np.random.default_rng(0).random((2, 30, 4))
    alone = preference_kernel(residuals[:1], 0.2, 0.0)
    residuals[1, :, :2] = np.nan
    residuals[:, :, 3] = np.nan
    found = preference_kernel(residuals, 0.2, 0.0)
    np.testing.assert_allclose(found[:2, :2], alone[:2, :2])
    np.testing.assert_allclose(found[0, 2], alone[0, 2])
    assert np.isnan(found[3]).all()
    assert np.isnan(found[:, 3]).all()


def test_hypotheses_that_are_none_come_last():
    residuals = np.array([[[1, 2], [2, 1], [np.inf, np.inf], [np.inf, np.inf]]])
    np.testing.assert_allclose(preference_kernel(residuals, 0.5, 0.0), np.ones((2, 2)))


@pytest.mark.parametrize("shape", [(3, 4), (2, 0, 3)])
def test_residuals_of_another_shape_are_an_error(shape):
    with pytest.raises(InputError):
        preference_kernel(np.zeros(shape), 0.2, 0.0)
