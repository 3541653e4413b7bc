import numpy as np
import pytest

from moseg.tasks.rigidity.linear_fit import FitLimits, fit_two_parameters

TRUE = np.array([0.02, 0.5])
STEEPER = np.array([0.02, 0.7])
LIMITS = FitLimits(samples=100, refined=10, iterations=20, points=20, share=0.2)


@pytest.fixture
def fit():
    """Function that fits 300 uneven tracks of `TRUE`, of which a share is of `STEEPER` and a share of nothing."""
    rng = np.random.default_rng(0)
    design = np.column_stack([rng.uniform(-600, 600, 300), rng.uniform(10, 180, 300)])
    noise, place = rng.normal(0, 1.0, 300), rng.permutation(300) / 300
    stray = rng.uniform(-60, 60, 300)

    def run(strays=0.5, steeper=0.0, seed=0, limits=LIMITS, is_allowed=lambda found: found[..., 1] > 0):
        values = np.where(place < steeper, design @ STEEPER, design @ TRUE) + noise
        values += np.where(place >= 1 - strays, stray, 0)
        one = np.ones(len(design))
        return fit_two_parameters(design, values, one, one, is_allowed, limits, np.random.default_rng(seed))

    return run


def test_most_tracks_decide(fit):
    np.testing.assert_array_less(np.abs(fit() - TRUE), [5e-4, 5e-3])


def test_refinement_makes_the_draw_irrelevant(fit):
    def spread(limits):
        return np.ptp([fit(seed=seed, limits=limits) for seed in range(10)], axis=0)[1] / TRUE[1]

    assert spread(LIMITS) < 1e-4
    assert spread(LIMITS._replace(refined=1, iterations=1)) > 1e-3


def test_the_larger_of_two_planes_is_found_if_several_pairs_are_refined(fit):
    def mistakes(refined):
        limits = LIMITS._replace(samples=25, refined=refined)
        found = [fit(strays=0.0, steeper=0.48, seed=seed, limits=limits) for seed in range(20)]
        return np.count_nonzero(np.array(found)[:, 1] > (TRUE[1] + STEEPER[1]) / 2)

    assert mistakes(refined=25) == 0
    assert mistakes(refined=1) > 0


def test_a_fit_that_is_not_allowed_is_not_found(fit):
    assert fit(is_allowed=lambda found: found[..., 1] < 0) is None


def test_what_is_allowed_before_it_is_refined_but_not_after_is_not_found(fit):
    assert fit(is_allowed=lambda found: np.abs(found[..., 1] - TRUE[1]) > 0.01) is None


@pytest.mark.parametrize(
    "limits", [LIMITS._replace(points=301), LIMITS._replace(points=250), LIMITS._replace(share=0.7)]
)
def test_too_few_tracks_agree(fit, limits):
    assert fit(limits=limits) is None
    assert fit(limits=LIMITS) is not None


def test_what_is_not_allowed_is_not_refined_in_place_of_what_is(fit):
    found = fit(strays=0.0, steeper=0.7, is_allowed=lambda found: found[..., 1] < 0.6)
    np.testing.assert_array_less(np.abs(found - TRUE), [1e-3, 1e-2])
