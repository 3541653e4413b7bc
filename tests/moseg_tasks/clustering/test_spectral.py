"""Co-regularised spectral embedding."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.linalg import ArpackNoConvergence

from moseg.tasks.clustering import embed_views, spectral
from moseg.tasks.clustering.spectral import normalise_affinity, unit_rows


def random_views(seed, num_views=2, size=9) -> np.ndarray:
    views = np.random.default_rng(seed).random((num_views, size, size)) ** 3
    return (views + views.transpose(0, 2, 1)) / 2


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), weight=st.floats(0.01, 5.0), num_views=st.integers(2, 3))
def test_the_objective_never_falls(seed, weight, num_views):
    objective = embed_views(random_views(seed, num_views), 3, weight, 30, 0.0).objective
    assert len(objective) > 1
    assert (np.diff(objective) >= -1e-12 * np.abs(objective[1:])).all()


def test_the_objective_of_one_view_is_the_sum_of_its_leading_eigenvalues():
    result = embed_views(random_views(0, 1), 3, 0.5, 10, 0.0)
    np.testing.assert_allclose(result.objective, [result.eigenvalues[0, :3].sum()])


def test_the_objective_of_agreeing_views_by_hand():
    # Identical views: each has the same leading eigenvectors, and tr(UU'UU') = k.
    view = random_views(3, 1)[0]
    result = embed_views(np.stack([view, view]), 2, 0.7, 10, 1e-12)
    np.testing.assert_allclose(result.objective[-1], 2 * result.eigenvalues[0, :2].sum() + 0.7 * 2)


def test_co_regularisation_brings_views_together():
    def disagreement(weight):
        first, second = np.split(embed_views(random_views(5), 2, weight, 50, 0.0).coordinates, 2, axis=1)
        return np.linalg.norm(first @ first.T - second @ second.T)

    assert disagreement(5.0) < 0.5 * disagreement(0.0)


def test_leading_eigenvalue_of_a_normalised_affinity_is_one():
    for view in random_views(1, 4):
        assert np.linalg.eigvalsh(normalise_affinity(view))[-1] == pytest.approx(1.0)


def test_normalising_both_sides_or_rows_gives_the_same_eigenvalues():
    view = random_views(2, 1)[0]
    rows = np.linalg.eigvals(view / view.sum(axis=1, keepdims=True))
    np.testing.assert_allclose(np.sort(rows.real), np.linalg.eigvalsh(normalise_affinity(view)), atol=1e-12)


def test_one_view_reads_no_co_regularisation():
    view = random_views(6, 1)
    np.testing.assert_array_equal(embed_views(view, 3).coordinates, embed_views(view, 3, 0.7, 10, 0.0).coordinates)


def test_of_one_view_normalising_both_sides_or_rows_gives_the_same_embedding():
    view = random_views(8, 1)[0]
    degrees = view.sum(axis=1, keepdims=True)
    values, vectors = np.linalg.eig(view / degrees)
    leading = vectors.real[:, np.argsort(-values.real)[:3]]
    rows = unit_rows(leading / np.sqrt((degrees * leading**2).sum(axis=0)))
    ours = embed_views(view[None], 3).coordinates
    np.testing.assert_allclose(np.abs(np.sum(rows * ours, axis=0)), np.linalg.norm(ours, axis=0) ** 2, atol=1e-6)


def test_an_object_without_any_affinity_does_not_divide_by_zero():
    view = random_views(4, 1, size=5)
    view[0, 2] = view[0, :, 2] = 0.0
    assert np.isfinite(embed_views(view, 2, 0.1, 5, 0.0).coordinates).all()


def test_eigenpairs_are_found_where_the_iterative_solver_ends_without_them(monkeypatch):
    points = np.random.default_rng(0).random((300, 2))
    affinity = np.exp(-np.linalg.norm(points[:, None] - points, axis=2))
    expected = spectral.leading_eigenpairs(affinity, 5)

    def fail(*arguments, **options):
        raise ArpackNoConvergence("no convergence", np.empty(0), np.empty((300, 0)))

    monkeypatch.setattr(spectral, "eigsh", fail)
    for found, wanted in zip(spectral.leading_eigenpairs(affinity, 5), expected, strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-6)
