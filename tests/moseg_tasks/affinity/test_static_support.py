"""How far a view supports that an object is part of the static background."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import AffinityParams
from moseg.tasks.affinity import residual_affinity, static_support

DEFAULT = AffinityParams()
PLAIN = AffinityParams(scale=0.5, relative=0.0, relative_flow=0.0)


def one_object(under_background: float, own: float = 0.0, background: float = 0.0) -> np.ndarray:
    """Residuals (1, 2, 2), px², of an object under the background's model and its own, and of the background."""
    return np.array([[[background, under_background], [900.0, own]]])


def test_support_falls_to_exp_half_at_the_scale():
    assert static_support(one_object(0.25), PLAIN) == pytest.approx([1.0, np.exp(-0.5)])


def test_a_background_with_large_residuals_supports_no_static_object():
    # The object is left 2 px, the background 1.9 px by the same model: no outlier, and no sign of rest.
    residuals = one_object(2.0**2, own=0.1, background=1.9**2)
    assert residual_affinity(residuals, DEFAULT)[0, 1] > 0.5
    assert static_support(residuals, DEFAULT)[1] < 0.05


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), has_energy=st.booleans())
def test_support_never_exceeds_the_affinity_to_the_background(seed, has_energy):
    rng = np.random.default_rng(seed)
    residuals = rng.exponential(2.0, (5, 4, 4))
    energy = rng.exponential(50.0, (5, 4)) if has_energy else None
    support, affinity = static_support(residuals, DEFAULT, energy), residual_affinity(residuals, DEFAULT, energy)
    assert ((support >= 0) & (support <= affinity[0] + 1e-12)).all()


def test_what_an_objects_own_model_leaves_is_no_motion():
    assert static_support(one_object(4.0, own=4.0), DEFAULT)[1] == 1.0
    assert static_support(one_object(4.0, own=4.0), DEFAULT.model_copy(update={"excess": False}))[1] < 0.7


def test_error_in_proportion_to_the_flow_is_tolerated():
    fast, slow = (static_support(one_object(1.0), DEFAULT, np.array([[0.0, e**2]]))[1] for e in (40.0, 1.0))
    assert fast > 0.8 > 0.2 > slow


def test_an_object_never_visible_with_the_background_has_no_support():
    residuals = np.concatenate([one_object(0.0)] * 3)
    residuals[:, 0, 1] = np.nan
    assert static_support(residuals, DEFAULT) == pytest.approx([1.0, np.nan], nan_ok=True)
    assert static_support(residuals[:0], DEFAULT) == pytest.approx([1.0, np.nan], nan_ok=True)
    residuals[0, 0, 1] = 0.0
    assert static_support(residuals, DEFAULT) == pytest.approx([1.0, 1.0])


def test_one_bad_pair_does_not_decide():
    residuals = np.concatenate([one_object(0.25)] * 3)
    residuals[1, 0, 1] = 1e6
    assert static_support(residuals, PLAIN)[1] == pytest.approx(np.exp(-0.5))


@pytest.mark.parametrize("num_pairs", [16, 21, 29, 31, 39])
def test_the_end_of_a_video_counts_like_its_start(num_pairs):
    residuals = np.zeros((num_pairs, 2, 2))
    for rests in (slice(None, -10), slice(10, None)):
        residuals[:, 0, 1] = 25.0
        residuals[rests, 0, 1] = 0.0
        assert static_support(residuals, DEFAULT)[1] < 0.01


def test_an_object_that_rests_most_of_the_time_still_moves():
    moving, resting = one_object(9.0), one_object(0.0)
    residuals = np.concatenate([moving] * 14 + [resting] * 60)
    assert static_support(residuals, DEFAULT)[1] < 0.1
    assert static_support(np.concatenate([moving] * 4 + [resting] * 60), DEFAULT)[1] > 0.9


def test_a_few_pairs_of_a_run_that_shows_little_do_not_decide():
    moving, resting, absent = one_object(9.0), one_object(0.0), one_object(np.nan, own=np.nan)
    assert static_support(np.concatenate([moving] * 4 + [absent] * 12 + [resting] * 60), DEFAULT)[1] > 0.9
    assert static_support(np.concatenate([moving] * 12 + [absent] * 4 + [resting] * 60), DEFAULT)[1] < 0.1


def test_a_motion_across_the_ends_of_runs_is_seen():
    length, moving, resting = DEFAULT.static_pairs, one_object(9.0), one_object(0.0)
    residuals = np.concatenate([resting] * (length // 2) + [moving] * length + [resting] * 4 * length)
    residuals[[length // 2, -1 - 4 * length], 0, 1] = 0.0
    assert static_support(residuals, DEFAULT)[1] < 0.1
