import numpy as np

from moseg.tasks.flow.fill_unknown import fill_unknown


def test_unknown_pixels_get_the_vector_of_the_nearest_known_pixel():
    flow = np.zeros((3, 6, 2), np.float32)
    flow[:, :2], flow[:, 4:] = (1, -2), (3, 4)
    expected = flow.copy()
    expected[:, 2], expected[:, 3] = (1, -2), (3, 4)
    flow[:, 2, 0], flow[:, 3] = np.nan, np.inf
    filled = fill_unknown(flow)
    assert filled.dtype == np.float32
    np.testing.assert_array_equal(filled, expected)


def test_a_known_flow_is_unchanged():
    flow = np.random.default_rng(0).normal(size=(4, 5, 2)).astype(np.float32)
    assert fill_unknown(flow) is flow


def test_a_flow_unknown_everywhere_is_zero():
    assert not fill_unknown(np.full((2, 3, 2), np.nan, np.float32)).any()
