import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import ForegroundParams
from moseg.tasks.saliency import foreground_probability

PARAMS = ForegroundParams()
SHAPE = (5, 7)
USUAL = 0.6
NEUTRAL = {"saliency": PARAMS.threshold, "reliability": USUAL, "misfit": 0.0, "colour": 0.0}
RANGES = {"saliency": (0, 1), "reliability": (0, 1), "misfit": (0, 12), "colour": (-4, 4)}


def probability_of(params=PARAMS, **evidence) -> np.ndarray:
    maps = {name: np.full(SHAPE, value, np.float32) for name, value in (NEUTRAL | evidence).items()}
    return foreground_probability(**maps, usual_reliability=USUAL, params=params)


def logit_of(**evidence) -> float:
    probability = float(probability_of(**evidence)[0, 0])
    return np.log(probability / (1 - probability))


def test_evidence_that_says_nothing_leaves_it_open():
    probability = probability_of()
    assert probability.shape == SHAPE and probability.dtype == np.float32
    np.testing.assert_allclose(probability, 0.5, atol=1e-6)


@settings(max_examples=60, deadline=None)
@given(st.data(), st.sampled_from([("saliency", 1), ("reliability", 1), ("colour", 1), ("misfit", -1)]))
def test_the_foreground_rises_with_all_evidence_but_the_misfit(data, evidence):
    name, sign = evidence
    drawn = {each: data.draw(st.floats(*limits, width=32)) for each, limits in RANGES.items()}
    low, high = sorted((drawn.pop(name), data.draw(st.floats(*RANGES[name], width=32))))
    lower, higher = probability_of(**drawn, **{name: low}), probability_of(**drawn, **{name: high})
    assert (sign * (higher - lower) >= -1e-6).all()
    assert (lower >= 0).all() and (lower <= 1).all()


@pytest.mark.parametrize(
    ("name", "low", "high"), [("saliency", 0.5, 0.6), ("reliability", 0.3, 0.5), ("colour", 0, 1), ("misfit", 5, 4)]
)
def test_every_evidence_moves_it(name, low, high):
    assert logit_of(**{name: high}) > logit_of(**{name: low}) + 0.1


@given(st.floats(USUAL, 1))
def test_flow_more_consistent_than_usual_gains_nothing(reliability):
    assert logit_of(reliability=reliability) == pytest.approx(0, abs=1e-5)


def test_flow_less_consistent_than_usual_loses_the_log_of_the_ratio():
    floor = PARAMS.reliability_floor
    expected = PARAMS.reliability_weight * np.log((floor + 0.1) / (floor + USUAL))
    assert logit_of(reliability=0.1) == pytest.approx(expected, rel=1e-3)


def test_colour_adds_its_weighted_log_ratio():
    assert logit_of(colour=2.0) == pytest.approx(2 * PARAMS.colour_weight, rel=1e-4)


def test_a_deviation_within_the_tolerance_costs_less_than_one_beyond_it():
    def misfit(spreads):
        return np.log1p(spreads**2)

    cost = [-logit_of(misfit=misfit(spreads * PARAMS.misfit_tolerance)) for spreads in (0.3, 1.0, 10.0)]
    expected = [PARAMS.misfit_weight * np.log1p(spreads**2) for spreads in (0.3, 1.0, 10.0)]
    np.testing.assert_allclose(cost, expected, rtol=1e-3)


def test_evidence_of_weight_zero_is_not_heard():
    deaf = PARAMS.model_copy(update={"colour_weight": 0.0, "reliability_weight": 0.0, "misfit_weight": 0.0})
    heard = probability_of(deaf, reliability=0.05, misfit=8.0, colour=3.0)
    np.testing.assert_array_equal(heard, probability_of(deaf))


def test_the_evidence_of_a_pixel_is_its_own():
    rng = np.random.default_rng(0)
    maps = [rng.uniform(*RANGES[name], SHAPE).astype(np.float32) for name in NEUTRAL]
    whole = foreground_probability(*maps, USUAL, PARAMS)
    part = foreground_probability(*(each[2:4, 1:5] for each in maps), USUAL, PARAMS)
    np.testing.assert_allclose(part, whole[2:4, 1:5], rtol=1e-6)
