import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.geometry.null_vector import iterated_null_vector


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**31), rows=st.integers(0, 20), size=st.integers(2, 30))
def test_it_is_the_last_right_singular_vector(seed, rows, size):
    A = np.random.default_rng(seed).normal(size=(4, size + rows, size))
    found = iterated_null_vector(A)
    np.testing.assert_allclose(np.linalg.norm(found, axis=-1), 1)
    least = np.linalg.svd(A, compute_uv=False)[:, -1]
    np.testing.assert_allclose(np.linalg.norm((A @ found[..., None])[..., 0], axis=-1), least, rtol=0.02, atol=1e-12)


def test_an_exact_solution_is_found_to_rounding():
    rng = np.random.default_rng(0)
    solution = rng.normal(size=(50, 27))
    solution /= np.linalg.norm(solution, axis=-1, keepdims=True)
    A = rng.normal(size=(50, 40, 27))
    A -= (A @ solution[..., None]) * solution[:, None, :]
    cosine = np.abs(np.sum(iterated_null_vector(A) * solution, axis=-1))
    np.testing.assert_allclose(cosine, 1, atol=1e-12)


def test_zero_and_rank_deficient_systems_stay_finite():
    A = np.zeros((3, 6, 5))
    A[1, :, 0] = 1
    A[2, :3, :3] = np.eye(3)
    found = iterated_null_vector(A)
    np.testing.assert_allclose(np.linalg.norm(found, axis=-1), 1)
    np.testing.assert_allclose(A @ found[..., None], 0, atol=1e-12)
