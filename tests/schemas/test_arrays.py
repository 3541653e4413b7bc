"""Layouts of arrays: rounding to the step of a layout."""

import numpy as np
import pytest

from moseg.schemas.arrays import layout, round_arrays


@pytest.mark.parametrize("dtype", ["float16", "float32", "float64"])
def test_values_are_rounded_to_multiples_of_the_step(dtype):
    array = np.linspace(-3, 3, 1001).astype(dtype)
    found = round_arrays({"x": array}, {"x": layout(dtype, "y", step=1 / 64)})["x"]
    assert found.dtype == array.dtype
    assert np.array_equal(found * 64, np.rint(found * 64))
    assert np.abs(found - array).max() <= 1 / 128


def test_rounding_keeps_large_and_unknown_values():
    array = np.array([np.nan, np.inf, 65504, -65504, 0.5], np.float16)
    found = round_arrays({"x": array}, {"x": layout("float16", "y", step=1 / 1024)})["x"]
    assert np.array_equal(found, array, equal_nan=True)


def test_arrays_without_a_step_are_not_copied():
    array = np.arange(3.0)
    assert round_arrays({"x": array}, {"x": layout("float64", "y")})["x"] is array
    assert round_arrays({"x": array}, {})["x"] is array


def test_rounding_of_many_values_is_that_of_each():
    array = np.random.default_rng(0).normal(size=(3, 240, 427)).astype(np.float16)
    found = round_arrays({"x": array}, {"x": layout("float16", "frame y x", step=1 / 64)})["x"]
    assert found.shape == array.shape and np.array_equal(found, (np.rint(array.astype(float) * 64) / 64).astype("f2"))
