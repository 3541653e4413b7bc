import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.tasks.saliency import motion_logit, probability


@given(st.floats(0.05, 0.95))
def test_saliency_at_the_threshold_speaks_neither_for_nor_against(threshold):
    assert motion_logit(np.float32([threshold]), threshold, 1.5) == pytest.approx(0, abs=1e-5)


@given(st.floats(0.001, 0.999), st.floats(0.5, 3))
def test_the_logit_and_the_probability_are_each_other_s_inverse(share, sharpness):
    logit = motion_logit(np.float32([share]), 0.5, sharpness)
    assert logit.dtype == np.float32
    np.testing.assert_allclose(probability(logit / np.float32(sharpness)), share, rtol=1e-3)


@given(st.lists(st.floats(0, 1, width=16), min_size=2, max_size=20))
def test_the_logit_grows_with_saliency_and_is_finite_at_certainty(saliency):
    logits = motion_logit(np.sort(np.array(saliency, np.float16)), 0.6, 1.5)
    assert np.isfinite(logits).all() and (np.diff(logits) >= 0).all()


def test_the_logit_is_the_odds_over_those_of_the_threshold():
    odds = (0.9 / 0.1) / (0.6 / 0.4)
    np.testing.assert_allclose(
        probability(motion_logit(np.float32([0.9]), 0.6, 1.5)), odds**1.5 / (1 + odds**1.5), 1e-4
    )


def test_any_logit_has_a_probability():
    np.testing.assert_allclose(probability(np.float32([-1e4, -200, 0, 200, 1e4])), [0, 0, 0.5, 1, 1], atol=1e-6)
