import numpy as np
import pytest

from moseg.tasks.geometry import normalise_points, normalising_transform, pixel_scale
from moseg.tasks.geometry.coordinates import hartley_transform, homogeneous


def test_the_image_centre_is_the_origin_and_half_the_longer_side_the_unit():
    corners = np.array([[0.0, 0.0], [853.0, 479.0], [426.5, 239.5]])
    expected = np.array([[-853, -479], [853, 479], [0, 0]]) / 854
    np.testing.assert_allclose(normalise_points(corners, (480, 854)), expected, atol=1e-15)
    assert pixel_scale((480, 854)) == pixel_scale((854, 480)) == 427


def test_the_transform_does_what_the_function_does():
    points = np.random.default_rng(0).uniform(0, 400, (10, 2))
    transformed = homogeneous(points) @ normalising_transform((240, 426)).T
    np.testing.assert_allclose(transformed[:, :2], normalise_points(points, (240, 426)), atol=1e-14)


def test_hartley_centres_and_scales_each_set():
    points = np.random.default_rng(0).normal(50, 9, (4, 12, 2))
    normalised, transform = hartley_transform(points)
    np.testing.assert_allclose(normalised.mean(axis=1), 0, atol=1e-12)
    np.testing.assert_allclose(np.mean(np.sum(normalised**2, axis=-1), axis=-1), 2)
    mapped = homogeneous(points) @ np.swapaxes(transform, -1, -2)
    np.testing.assert_allclose(mapped[..., :2], normalised, atol=1e-12)


def test_coincident_points_stay_finite():
    normalised, transform = hartley_transform(np.full((8, 2), 3.0))
    assert (normalised == 0).all()
    assert transform[0, 0] == pytest.approx(1)
