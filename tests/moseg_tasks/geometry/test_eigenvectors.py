"""Laws of extreme eigenvectors by powers of matrices."""

import numpy as np
import pytest

from moseg.tasks.geometry import eigenvectors
from moseg.tasks.geometry.eigenvectors import largest_eigenvector, smallest_eigenvector


def _matrices(eigenvalues, num=50, seed=0):
    size = len(eigenvalues)
    Q = np.linalg.qr(np.random.default_rng(seed).normal(size=(num, size, size)))[0]
    return (Q * eigenvalues) @ np.swapaxes(Q, 1, 2), Q


@pytest.mark.parametrize("scale", [1e-100, 1.0, 1e100])
def test_the_vectors_of_the_extreme_eigenvalues_are_found(scale):
    M, Q = _matrices(scale * np.array([1e-6, 3e-6, 0.1, 0.2, 0.3, 1, 2, 2.5, 9]))
    assert np.abs(np.sum(smallest_eigenvector(M) * Q[..., 0], axis=1)) == pytest.approx(1, abs=1e-9)
    assert np.abs(np.sum(largest_eigenvector(M) * Q[..., -1], axis=1)) == pytest.approx(1, abs=1e-9)


def test_a_null_vector_of_a_singular_matrix_is_found():
    M, Q = _matrices(np.array([0, 0.5, 1, 1]))
    assert np.abs(np.sum(smallest_eigenvector(M) * Q[..., 0], axis=1)) == pytest.approx(1, abs=1e-9)


def test_a_matrix_that_the_ridge_leaves_without_inverse_has_a_vector_too(monkeypatch):
    monkeypatch.setattr(eigenvectors, "_RIDGE", 0.0)
    M = np.stack([np.diag([2.0, 0.0, 1.0]), np.diag([1e-3, 1.0, 3.0])])
    np.testing.assert_allclose(np.abs(smallest_eigenvector(M)), [[0, 1, 0], [1, 0, 0]], atol=1e-12)


def test_vectors_of_equal_eigenvalues_are_in_their_space():
    M, Q = _matrices(np.array([1e-3, 1e-3, 1, 2]))
    inside = np.linalg.norm(smallest_eigenvector(M)[:, None] @ Q[..., :2], axis=2)
    assert inside == pytest.approx(1, abs=1e-9)


def test_zeros_give_finite_vectors():
    zeros = np.zeros((2, 9, 9))
    assert np.linalg.norm(smallest_eigenvector(zeros), axis=1) == pytest.approx(1)
    assert not largest_eigenvector(zeros).any()
