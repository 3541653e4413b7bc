import numpy as np

from moseg.tasks.geometry.homography import homography_dlt, homography_sampson_squared

H_TRUE = np.array([[1.02, 0.03, 5.0], [-0.02, 0.98, -3.0], [1e-5, -2e-5, 1.0]])


def transfer(H, points):
    mapped = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ H.T
    return mapped[:, :2] / mapped[:, 2:]


def test_four_exact_points_give_back_the_homography():
    points0 = np.array([[0.0, 0.0], [800.0, 10.0], [30.0, 470.0], [820.0, 460.0]])
    H = homography_dlt(points0, transfer(H_TRUE, points0))
    np.testing.assert_allclose(H / H[2, 2], H_TRUE, atol=1e-9)


def test_exact_points_have_no_residual():
    points0 = np.random.default_rng(0).uniform(0, 800, (30, 2))
    points1 = transfer(H_TRUE, points0)
    H = homography_dlt(points0, points1)
    assert homography_sampson_squared(H, points0, points1).max() < 1e-9


def test_under_the_identity_half_the_squared_displacement_is_left():
    points0 = np.random.default_rng(0).uniform(0, 800, (6, 2))
    np.testing.assert_allclose(homography_sampson_squared(np.eye(3), points0, points0 + np.array([3.0, 4.0])), 12.5)


def test_swapping_images_and_inverting_changes_little():
    points0 = np.random.default_rng(0).uniform(0, 800, (6, 2))
    points1 = transfer(H_TRUE, points0) + np.array([0.5, -0.2])
    there = homography_sampson_squared(H_TRUE, points0, points1)
    back = homography_sampson_squared(np.linalg.inv(H_TRUE), points1, points0)
    np.testing.assert_allclose(there, back, rtol=1e-2)
