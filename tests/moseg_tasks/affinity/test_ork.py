"""Weighted ordered-residual kernel."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import AffinityParams
from moseg.tasks.affinity import estimate_affinity, ork_affinity

RESIDUALS = np.array([[[1.0, 2.0, 9.0], [4.0, 3.0, 8.0], [7.0, 5.0, 6.0]]])  # [pair, model, data]


def params(reading="models", threshold=2) -> AffinityParams:
    return AffinityParams(method="ork", ork_reading=reading, ork_threshold=threshold)


def test_ranking_models_for_each_objects_data_by_hand():
    # Columns ranked: (0, 1, 2), (0, 1, 2), (2, 1, 0); scores (2, 1, 0), (2, 1, 0), (0, 1, 2).
    expected = [[5, 5, 1], [5, 5, 1], [1, 1, 5]]
    np.testing.assert_array_equal(ork_affinity(RESIDUALS, params()), expected)


def test_ranking_objects_under_each_model_by_hand():
    # Rows ranked: (0, 1, 2), (1, 0, 2), (2, 0, 1); scores (2, 1, 0), (1, 2, 0), (0, 2, 1).
    expected = [[5, 4, 2], [4, 5, 4], [2, 4, 5]]
    np.testing.assert_array_equal(ork_affinity(RESIDUALS, params("objects")), expected)


@pytest.mark.parametrize("reading", ["models", "objects"])
def test_only_the_order_of_residuals_counts(reading):
    residuals = np.random.default_rng(0).random((4, 6, 6))
    np.testing.assert_array_equal(
        ork_affinity(residuals**3 * 100, params(reading, 3)), ork_affinity(residuals, params(reading, 3))
    )


@pytest.mark.parametrize("reading", ["models", "objects"])
def test_the_order_of_objects_has_no_effect_even_among_equal_residuals(reading):
    rng = np.random.default_rng(1)
    residuals = rng.integers(0, 3, (5, 6, 6)).astype(float)
    order = rng.permutation(6)
    shuffled = ork_affinity(residuals[:, order][:, :, order], params(reading, 3))
    np.testing.assert_allclose(shuffled, ork_affinity(residuals, params(reading, 3))[np.ix_(order, order)], atol=1e-12)


@pytest.mark.parametrize("reading", ["models", "objects"])
def test_an_absent_object_takes_no_part(reading):
    residuals = np.random.default_rng(2).random((3, 4, 4))
    residuals[0, 3, :] = residuals[0, :, 3] = np.nan
    without = residuals[:1, :3, :3]
    affinity = ork_affinity(residuals, params(reading))
    first = ork_affinity(residuals[:1], params(reading))
    np.testing.assert_array_equal(first[:3, :3], ork_affinity(without, params(reading)))
    assert np.isnan(first[3]).all() and np.isnan(first[:, 3]).all()
    rest = ork_affinity(residuals[1:], params(reading))
    np.testing.assert_allclose(affinity[3], rest[3])  # the mean over the two pairs in which it is there


def test_residuals_that_are_not_square_are_an_input_error():
    with pytest.raises(InputError, match=r"wrong shape of residuals in affinity; got \(3, 4\)"):
        estimate_affinity(np.zeros((3, 4)), params())
