"""Affinity from residual size."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import AffinityParams
from moseg.tasks.affinity import estimate_affinity, residual_affinity

PLAIN = AffinityParams(scale=0.5, relative=0.0, relative_flow=0.0, excess=False, direction="min")


def with_background(to_object: float, from_object: float, own: float = 0.0) -> np.ndarray:
    """Residuals (1, 2, 2) of the background and one object."""
    return np.array([[[0.0, to_object], [from_object, own]]])


def test_affinity_falls_to_exp_half_at_the_scale():
    assert residual_affinity(with_background(0.25, 9.0), PLAIN)[0, 1] == pytest.approx(np.exp(-0.5))


@pytest.mark.parametrize(("direction", "distance"), [("min", 1.0), ("max", 1.8), ("mean", 1.4), ("background", 1.8)])
def test_direction(direction, distance):
    params = PLAIN.model_copy(update={"direction": direction})
    residuals = with_background((0.5 * 1.8) ** 2, (0.5 * 1.0) ** 2)
    assert residual_affinity(residuals, params)[0, 1] == pytest.approx(np.exp(-(distance**2) / 2))


def test_two_objects_beside_the_background_take_the_smaller_direction():
    residuals = np.full((1, 3, 3), 0.0)
    residuals[0, 1, 2], residuals[0, 2, 1] = 400.0, 0.25
    params = PLAIN.model_copy(update={"direction": "background"})
    assert residual_affinity(residuals, params)[1, 2] == pytest.approx(np.exp(-0.5))


def test_what_an_objects_own_model_leaves_is_not_another_motion():
    params = AffinityParams()
    non_rigid = with_background(2.0, 900.0, own=2.0)
    assert residual_affinity(non_rigid, params)[0, 1] == 1.0
    assert residual_affinity(non_rigid, params.model_copy(update={"excess": False}))[0, 1] < 0.8


def test_error_in_proportion_to_the_flow_is_tolerated_for_flow_only():
    residuals = with_background(1.0, 1.0)
    fast, slow = np.array([[0.0, 40.0**2]]), np.array([[0.0, 1.0]])
    affinities = [estimate_affinity(residuals, AffinityParams(), energy)[0, 1] for energy in (fast, slow, None)]
    assert affinities[0] > 0.8
    assert affinities[1] == pytest.approx(affinities[2], rel=0.05)
    assert affinities[2] < 0.2


def test_median_over_pairs_ignores_a_bad_pair_and_missing_pairs():
    residuals = np.concatenate([with_background(0.25, 9.0)] * 4)
    residuals[0, 0, 1] = 1e6
    residuals[1, 1, :] = residuals[1, :, 1] = np.nan
    assert residual_affinity(residuals, PLAIN)[0, 1] == pytest.approx(np.exp(-0.5))


def test_an_invalid_model_leaves_the_other_direction():
    for direction in ("min", "max", "mean", "background"):
        residuals = with_background(np.nan, 0.25)
        params = PLAIN.model_copy(update={"direction": direction})
        assert residual_affinity(residuals, params)[0, 1] == pytest.approx(np.exp(-0.5))


def test_objects_never_visible_together_are_unknown_not_different():
    residuals = np.zeros((2, 3, 3))
    residuals[0, 1, :] = residuals[0, :, 1] = np.nan
    residuals[1, 2, :] = residuals[1, :, 2] = np.nan
    affinity = residual_affinity(residuals, AffinityParams())
    assert np.isnan(affinity[1, 2]) and np.isnan(affinity[2, 1])
    assert np.count_nonzero(np.isnan(affinity)) == 2
    assert np.isnan(residual_affinity(residuals[:1], AffinityParams())[1, 1])
    assert np.isnan(residual_affinity(residuals[:0], AffinityParams())).all()


def test_very_different_motions_keep_their_order():
    residuals = np.zeros((1, 4, 4))
    residuals[0, 0, 1:] = residuals[0, 1:, 0] = 30.0**2, 60.0**2, 90.0**2
    affinity = residual_affinity(residuals, AffinityParams())[0]
    assert 1 > affinity[1] > affinity[2] > affinity[3] > 0


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), direction=st.sampled_from(["min", "mean", "max", "background"]))
def test_symmetric_bounded_and_blind_to_the_order_of_objects(seed, direction):
    rng = np.random.default_rng(seed)
    residuals = rng.gamma(0.5, 2.0, (5, 6, 6))
    residuals[rng.random((5, 6)) < 0.3] = np.nan
    params = AffinityParams(direction=direction)
    energy = rng.random((5, 6)) * 20
    affinity = residual_affinity(residuals, params, energy)
    known = np.isfinite(affinity)
    np.testing.assert_array_equal(affinity, affinity.T)
    assert ((affinity[known] >= 0) & (affinity[known] <= 1)).all()
    order = np.concatenate([[0], 1 + rng.permutation(5)])
    shuffled = residual_affinity(residuals[:, order][:, :, order], params, energy[:, order])
    np.testing.assert_allclose(shuffled, affinity[np.ix_(order, order)], rtol=1e-12)


def test_energies_of_the_wrong_shape_are_an_input_error():
    with pytest.raises(InputError, match="wrong shape of energies"):
        estimate_affinity(np.zeros((3, 4, 4)), AffinityParams(), np.zeros((3, 5)))
