"""Quantiles of known values are those of numpy, and nothing is warned where none is known."""

import warnings

import numpy as np
import pytest

from moseg.tasks.affinity.quantiles import known_quantile


@pytest.mark.parametrize("quantile", [0.0, 0.3, 0.5, 1.0])
def test_it_is_the_quantile_of_the_known_values(quantile):
    values = np.random.default_rng(0).normal(size=(7, 3, 4))
    values[np.random.default_rng(1).random(values.shape) < 0.3] = np.nan
    values[:, 1, 2] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected = np.nanquantile(values, quantile, axis=0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = known_quantile(values, quantile)
    np.testing.assert_array_equal(found, expected)
    assert np.isnan(found[1, 2])


def test_it_is_unknown_without_values():
    assert np.isnan(known_quantile(np.empty((0, 2)), 0.5)).all()
