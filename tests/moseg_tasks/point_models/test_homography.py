import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.geometry.coordinates import homogeneous
from moseg.tasks.geometry.homography import homography_dlt, homography_sampson_squared
from moseg.tasks.point_models import Correspondences, point_model

MODEL = point_model("homography")
properties = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 2**31)


def same_up_to_scale(first, second, tolerance=1e-6):
    first, second = first / np.linalg.norm(first), second / np.linalg.norm(second)
    return min(np.abs(first - second).max(), np.abs(first + second).max()) < tolerance


@properties
@given(seed=seeds)
def test_four_points_in_closed_form_agree_with_the_linear_transform(obey, noisy, seed):
    data = noisy(obey("homography", num_points=4, seed=seed), 1.0, seed)
    if not MODEL.degenerate(data):
        assert same_up_to_scale(MODEL.fit(data), homography_dlt(data.points[:, 0], data.points[:, 1]))


@properties
@given(seed=seeds)
def test_matrix_products_give_the_sampson_distance(obey, noisy, seed):
    data = noisy(obey("homography", seed=seed), 1.0, seed)
    H = MODEL.fit(data)[None]
    expected = homography_sampson_squared(H, data.points[:, 0], data.points[:, 1])
    np.testing.assert_allclose(MODEL.residual(H, data), expected, rtol=1e-7, atol=1e-10)


@properties
@given(seed=seeds)
def test_the_inverse_explains_the_swapped_frames_to_first_order(obey, noisy, seed):
    data = noisy(obey("homography", seed=seed), 0.3, seed)
    H = MODEL.fit(data)
    residual = MODEL.residual(H[None], data)
    swapped = MODEL.residual(np.linalg.inv(H)[None], data._replace(points=data.points[:, ::-1]))
    np.testing.assert_allclose(swapped, residual, rtol=0.05, atol=1e-3)


@properties
@given(seed=seeds)
def test_a_projective_change_of_coordinates_changes_the_homography_with_it(obey, noisy, seed):
    data = noisy(obey("homography", num_points=4, seed=seed), 1.0, seed)
    rng = np.random.default_rng(seed)
    changes = [
        np.eye(3) + rng.uniform(-1, 1, (3, 3)) * [[0.1, 0.1, 50], [0.1, 0.1, 50], [1e-4, 1e-4, 0]] for _ in range(2)
    ]
    mapped = [homogeneous(data.points[:, frame]) @ changes[frame].T for frame in (0, 1)]
    points = np.stack([m[:, :2] / m[:, 2:] for m in mapped], axis=1)
    if not MODEL.degenerate(data):
        expected = changes[1] @ MODEL.fit(data) @ np.linalg.inv(changes[0])
        assert same_up_to_scale(MODEL.fit(Correspondences(points)), expected)


@pytest.mark.parametrize("frame", [0, 1])
def test_three_collinear_points_of_four_are_degenerate_in_either_frame(obey, frame):
    points = obey("homography", num_points=4).points
    points[2, frame] = (points[0, frame] + 3 * points[1, frame]) / 4
    assert MODEL.degenerate(Correspondences(points))
    assert np.isfinite(MODEL.fit(Correspondences(points))).all()


def test_a_plane_and_a_rotation_are_met_exactly(follow, scatter):
    points = scatter(50)
    plane = points * (20 / (points @ [0.2, 0.4, 1.0]))[:, None]
    scenes = [follow(plane), follow(points, centres=((0, 0, 0), (0, 0, 0)))]
    for scene in scenes:
        data = Correspondences(scene[:, :2])
        assert MODEL.residual(MODEL.fit(data)[None], data).max() < 1e-9
