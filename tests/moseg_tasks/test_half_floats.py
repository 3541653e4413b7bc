import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from moseg.tasks.half_floats import to_float16, to_float32


def test_every_half_keeps_its_value_in_single_precision():
    halves = np.arange(2**16, dtype=np.uint16).view(np.float16).reshape(16, -1)
    singles = to_float32(halves)
    assert singles.dtype == np.float32
    np.testing.assert_array_equal(singles, halves.astype(np.float32))
    np.testing.assert_array_equal(to_float16(singles), halves)


@given(npst.arrays(np.float32, npst.array_shapes(max_dims=4), elements=st.floats(-60000, 60000, width=32)))
def test_a_single_is_rounded_to_the_nearest_half(singles):
    halves = to_float16(singles)
    assert halves.dtype == np.float16 and halves.shape == singles.shape
    np.testing.assert_array_equal(halves, singles.astype(np.float16))


@pytest.mark.parametrize("view", [np.s_[:, 1], np.s_[::2], np.s_[..., 0]])
def test_a_view_of_a_larger_array_is_converted_as_it_reads(view):
    halves = np.random.default_rng(0).normal(0, 30, (4, 3, 5)).astype(np.float16)
    np.testing.assert_array_equal(to_float32(halves[view]), halves[view].astype(np.float32))
