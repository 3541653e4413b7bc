import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.geometry.coordinates import homogeneous
from moseg.tasks.geometry.sampson import sampson_squared
from moseg.tasks.point_models import Correspondences, point_model

MODEL = point_model("fundamental")
properties = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 2**31)


@properties
@given(seed=seeds)
def test_matrix_products_give_the_sampson_distance(obey, noisy, seed):
    data = noisy(obey("fundamental", seed=seed), 1.0, seed)
    F = MODEL.fit(data)[None]
    expected = sampson_squared(F, data.points[:, 0], data.points[:, 1])
    np.testing.assert_allclose(MODEL.residual(F, data), expected, rtol=1e-6, atol=1e-9)


def test_a_point_on_its_epipole_has_no_residual():
    F = np.array([[0.0, -1, 187], [1, 0, -620], [-187, 620, 0]])  # straight ahead: both epipoles at (620, 187)
    points = np.array([[[620.0, 187.0], [620.0, 187.0]], [[700.0, 187.0], [710.0, 190.0]]])
    residual = MODEL.residual(F[None], Correspondences(points))[0]
    assert residual[0] < 1e-9
    assert residual[1] == pytest.approx(sampson_squared(F, points[1:, 0], points[1:, 1])[0])


@properties
@given(seed=seeds)
def test_the_transpose_explains_the_swapped_frames_alike(obey, noisy, seed):
    data = noisy(obey("fundamental", seed=seed), 0.5, seed)
    swapped = data._replace(points=data.points[:, ::-1])
    residual = MODEL.residual(MODEL.fit(data)[None], data)
    np.testing.assert_allclose(MODEL.residual(MODEL.fit(swapped)[None], swapped), residual, rtol=1e-5, atol=1e-8)


@properties
@given(seed=seeds)
def test_a_projective_change_of_coordinates_changes_the_matrix_with_it(obey, seed):
    data = obey("fundamental", seed=seed)
    rng = np.random.default_rng(seed)
    changes = [
        np.eye(3) + rng.uniform(-1, 1, (3, 3)) * [[0.1, 0.1, 50], [0.1, 0.1, 50], [1e-4, 1e-4, 0]] for _ in range(2)
    ]
    mapped = [homogeneous(data.points[:, frame]) @ changes[frame].T for frame in (0, 1)]
    moved = Correspondences(np.stack([m[:, :2] / m[:, 2:] for m in mapped], axis=1))
    inverse0, inverse1 = (np.linalg.inv(change) for change in changes)
    assert MODEL.residual((inverse1.T @ MODEL.fit(data) @ inverse0)[None], moved).max() < 1e-9
    assert MODEL.residual((changes[1].T @ MODEL.fit(moved) @ changes[0])[None], data).max() < 1e-9


@properties
@given(seed=seeds)
def test_a_fundamental_matrix_has_rank_two_and_a_bilinear_relation_meets_its_sample(obey, noisy, seed):
    sample = noisy(obey("fundamental", num_points=8, seed=seed), 0.5, seed)
    bilinear = point_model("bilinear")
    K = np.array([[720.0, 0, 620], [0, 720, 187], [0, 0, 1]])
    singular = np.linalg.svd(K.T @ MODEL.fit(sample) @ K, compute_uv=False)
    assert singular[2] < 1e-9 * singular[0]
    assert bilinear.residual(bilinear.fit(sample)[None], sample).max() < 1e-9


@pytest.mark.parametrize("num_points", [8, 60])
def test_a_plane_is_degenerate(follow, scatter, num_points):
    points = scatter(num_points)
    plane = points * (20 / (points @ [0.2, 0.4, 1.0]))[:, None]
    assert MODEL.degenerate(Correspondences(follow(plane)[:, :2]))


@pytest.mark.parametrize("rotations_deg", [((1.0, 3.0, -1.0),), ((0.0, 0.0, 0.0),)])
@pytest.mark.parametrize("num_points", [8, 60])
def test_a_camera_without_translation_is_degenerate(follow, scatter, num_points, rotations_deg):
    points = follow(scatter(num_points), centres=((0, 0, 0),), rotations_deg=rotations_deg)
    assert MODEL.degenerate(Correspondences(points))


def test_a_plane_seen_with_the_noise_of_tracks_is_degenerate_once_the_limit_is_above_it(follow, scatter, noisy):
    points = scatter(60)
    plane = points * (20 / (points @ [0.2, 0.4, 1.0]))[:, None]
    data = noisy(Correspondences(follow(plane)[:, :2]), 0.1)
    assert type(MODEL)(min_conditioning=1e-3).degenerate(data)
    assert not type(MODEL)(min_conditioning=1e-3).degenerate(noisy(Correspondences(follow(points)[:, :2]), 0.1))
