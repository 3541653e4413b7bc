import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.point_models import Correspondences, point_model

MODEL = point_model("affine")
properties = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 2**31)


def test_three_points_are_met_exactly(obey):
    data = obey("homography", num_points=3)
    assert MODEL.residual(MODEL.fit(data)[None], data).max() < 1e-20


def test_the_distance_is_to_the_nearest_pair_of_the_model(obey, noisy):
    data = noisy(obey("affine"), 2.0)
    A = MODEL.fit(data)
    # Least squares over x0 of |x0 - p0|^2 + |A x0 - p1|^2.
    stacked = np.concatenate([np.eye(2), A[:, :2]])
    target = np.concatenate([data.points[:, 0], data.points[:, 1] - A[:, 2]], axis=1)
    nearest = np.linalg.lstsq(stacked, target.T)[0]
    expected = ((stacked @ nearest - target.T) ** 2).sum(axis=0)
    np.testing.assert_allclose(MODEL.residual(A[None], data)[0], expected, rtol=1e-8)


@properties
@given(seed=seeds)
def test_no_other_affine_map_has_less_residual(obey, noisy, seed):
    data = noisy(obey("affine", seed=seed), 1.0, seed)
    A = MODEL.fit(data)
    steps = np.random.default_rng(seed).normal(0, 1, (20, 2, 3)) * [1e-4, 1e-4, 1e-2]
    costs = MODEL.residual(A + steps, data).sum(axis=1)
    assert (costs >= MODEL.residual(A[None], data).sum() * (1 - 1e-9)).all()


@properties
@given(seed=seeds)
def test_the_inverse_map_explains_the_swapped_frames_alike(obey, noisy, seed):
    data = noisy(obey("affine", seed=seed), 1.0, seed)
    swapped = data._replace(points=data.points[:, ::-1])
    residual = MODEL.residual(MODEL.fit(data)[None], data)
    np.testing.assert_allclose(MODEL.residual(MODEL.fit(swapped)[None], swapped), residual, rtol=1e-6, atol=1e-9)


@properties
@given(seed=seeds)
def test_an_affine_change_of_coordinates_changes_the_map_with_it(obey, noisy, seed):
    data = noisy(obey("affine", seed=seed), 0.5, seed).take(np.arange(3))
    rng = np.random.default_rng(seed)
    changes = [np.eye(3) + rng.normal(0, 1, (3, 3)) * [[0.2, 0.2, 50], [0.2, 0.2, 50], [0, 0, 0]] for _ in range(2)]
    points = np.stack([data.points[:, f] @ changes[f][:2, :2].T + changes[f][:2, 2] for f in range(2)], axis=1)
    A = np.concatenate([MODEL.fit(data), [[0, 0, 1]]])
    if not MODEL.degenerate(data):
        expected = changes[1] @ A @ np.linalg.inv(changes[0])
        np.testing.assert_allclose(MODEL.fit(Correspondences(points)), expected[:2], rtol=1e-5, atol=1e-5)


def test_points_collinear_in_the_second_frame_alone_are_degenerate(obey):
    points = obey("affine").points
    points[:, 1, 1] = 100.0
    assert MODEL.degenerate(Correspondences(points))
    assert MODEL.degenerate(Correspondences(points[:, ::-1]))
