import numpy as np
import pytest
from scipy.optimize import minimize

from moseg.tasks.geometry.coordinates import homogeneous
from moseg.tasks.geometry.homography import homography_sampson_squared
from moseg.tasks.geometry.sampson import gradient_coefficients, gradient_monomials, sampson_squared

SIDEWAYS = np.array([[0.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""A camera that translates along x: epipolar lines are the rows."""


def test_sideways_motion_measures_the_change_of_row():
    points0 = np.array([[10.0, 20.0], [300.0, 5.0]])
    points1 = points0 + np.array([[7.0, 0.0], [-3.0, 2.0]])
    # Half of the squared deviation, for each of the two points takes one half of the move.
    np.testing.assert_allclose(sampson_squared(SIDEWAYS, points0, points1), [0, 2.0])


def test_scale_of_the_matrix_does_not_matter():
    points = np.random.default_rng(0).uniform(0, 100, (2, 5, 2))
    F = np.random.default_rng(1).normal(size=(3, 3))
    np.testing.assert_allclose(sampson_squared(-7 * F, *points), sampson_squared(F, *points))


def test_swapping_images_and_transposing_changes_nothing():
    points0, points1 = np.random.default_rng(0).uniform(0, 100, (2, 5, 2))
    F = np.random.default_rng(1).normal(size=(3, 3))
    np.testing.assert_allclose(sampson_squared(F.T, points1, points0), sampson_squared(F, points0, points1))


def test_models_come_first_and_points_last(see, scatter):
    views = see(scatter(5))
    stacked = np.stack([SIDEWAYS, views.F])
    distances = sampson_squared(stacked, views.points0, views.points1)
    assert distances.shape == (2, 5)
    assert distances[1].max() < 1e-18
    np.testing.assert_allclose(distances[0], sampson_squared(SIDEWAYS, views.points0, views.points1))


def test_a_point_on_its_epipole_has_no_residual():
    F = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]])
    assert sampson_squared(F, np.zeros((1, 2)), np.zeros((1, 2))) == pytest.approx(0)


def test_it_agrees_with_the_smallest_displacement_that_obeys_the_geometry(see, scatter):
    views = see(scatter(3))
    points1 = views.points1 + np.array([0.3, -0.4])
    F = views.F / np.linalg.norm(views.F)
    for index, sampson in enumerate(sampson_squared(F, views.points0, points1)):

        def algebraic(move, index=index):
            x0 = np.append(views.points0[index] + move[:2], 1)
            x1 = np.append(points1[index] + move[2:], 1)
            return 1e3 * (x1 @ F @ x0)

        least = minimize(
            lambda move: move @ move, np.zeros(4), constraints={"type": "eq", "fun": algebraic}, method="SLSQP"
        )
        assert sampson == pytest.approx(least.fun, rel=0.02)


def test_a_homography_is_stricter_than_any_epipolar_geometry_that_contains_it():
    rng = np.random.default_rng(0)
    points0, points1 = rng.uniform(0, 100, (2, 50, 2))
    H = np.eye(3) + 1e-3 * rng.normal(size=(3, 3))
    epipole = rng.normal(size=3)
    F = np.cross(np.eye(3), epipole) @ H
    assert (homography_sampson_squared(H, points0, points1) >= sampson_squared(F, points0, points1) - 1e-9).all()


def test_the_gradient_is_a_product_of_coefficients_and_monomials():
    rng = np.random.default_rng(0)
    F, points0, points1 = rng.normal(size=(4, 3, 3)), rng.normal(size=(20, 2)), rng.normal(size=(20, 2))
    gradient = gradient_coefficients(F) @ gradient_monomials(points0, points1)
    error = np.einsum("ni,hij,nj->hn", homogeneous(points1), F, homogeneous(points0))
    np.testing.assert_allclose(error**2 / gradient, sampson_squared(F, points0, points1), rtol=1e-9)
