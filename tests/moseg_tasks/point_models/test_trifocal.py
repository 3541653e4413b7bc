import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from moseg.tasks.geometry.coordinates import homogeneous
from moseg.tasks.point_models import Correspondences, TrifocalDegeneracy, point_model
from moseg.tasks.point_models.trifocal_tensor import epipoles, transform_tensor

MODEL = point_model("trifocal")
properties = settings(max_examples=15, deadline=None)
seeds = st.integers(0, 2**31)
STILL = (0.0, 0.0, 0.0)


def test_the_distance_is_that_to_the_nearest_point_in_space(follow, scatter, noisy):
    points = scatter(25)
    clean = Correspondences(follow(points))
    data = noisy(clean, 0.3)
    residual = MODEL.residual(MODEL.fit(Correspondences(follow(scatter(100, seed=1))))[None], data)[0]

    def distance(index):
        def reprojection(point):
            return (follow(point[None])[0] - data.points[index]).ravel()

        return 2 * least_squares(reprojection, points[index], xtol=1e-12, ftol=1e-12).cost

    np.testing.assert_allclose(residual, [distance(index) for index in range(25)], rtol=0.02)


def test_a_fitted_tensor_is_one_of_three_cameras(obey, noisy):
    T = MODEL.fit(noisy(obey("trifocal"), 1.0))
    K = np.array([[720.0, 0, 620.5], [0, 720.0, 187.0], [0, 0, 1]])
    T = transform_tensor(T, K, np.linalg.inv(K), np.linalg.inv(K))
    epipole1, epipole2 = epipoles(T)
    # All slices have rank two, and their null vectors are orthogonal to the epipoles.
    assert np.linalg.svd(T, compute_uv=False)[:, 2].max() < 1e-12
    U, _, Vh = np.linalg.svd(T)
    assert np.abs(U[:, :, 2] @ epipole1).max() < 1e-8
    assert np.abs(Vh[:, 2] @ epipole2).max() < 1e-8


def test_epipoles_are_the_images_of_the_first_centre(follow, obey):
    found = epipoles(MODEL.fit(obey("trifocal")))
    seen = follow(np.full((1, 3), 1e-9))[0, 1:]
    for epipole, expected in zip(found, seen, strict=True):
        np.testing.assert_allclose(epipole[:2] / epipole[2], expected, rtol=1e-5)


@properties
@given(seed=seeds)
def test_the_second_and_third_frame_may_be_swapped(obey, noisy, seed):
    data = noisy(obey("trifocal", seed=seed), 0.3, seed)
    swapped = data._replace(points=data.points[:, [0, 2, 1]])
    T = MODEL.fit(data)
    residual = MODEL.residual(T[None], data)
    np.testing.assert_allclose(MODEL.residual(np.swapaxes(T, -1, -2)[None], swapped), residual, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(MODEL.residual(MODEL.fit(swapped)[None], swapped), residual, rtol=1e-4, atol=1e-6)


@properties
@given(seed=seeds)
def test_any_order_of_the_frames_is_explained_without_noise(obey, seed):
    data = obey("trifocal", seed=seed)
    for order in ([1, 0, 2], [2, 1, 0], [1, 2, 0]):
        turned = data._replace(points=data.points[:, order])
        assert MODEL.residual(MODEL.fit(turned)[None], turned).max() < 1e-9


@properties
@given(seed=seeds)
def test_a_projective_change_of_coordinates_changes_the_tensor_with_it(obey, seed):
    data = obey("trifocal", seed=seed)
    rng = np.random.default_rng(seed)
    changes = [
        np.eye(3) + rng.uniform(-1, 1, (3, 3)) * [[0.1, 0.1, 50], [0.1, 0.1, 50], [1e-4, 1e-4, 0]] for _ in range(3)
    ]
    mapped = [homogeneous(data.points[:, frame]) @ changes[frame].T for frame in range(3)]
    moved = Correspondences(np.stack([m[:, :2] / m[:, 2:] for m in mapped], axis=1))
    T = transform_tensor(MODEL.fit(data), np.linalg.inv(changes[0]), changes[1], changes[2])
    assert MODEL.residual(T[None], moved).max() < 1e-9


def test_two_motions_on_one_epipolar_plane_are_separated(follow, scatter):
    # A point that moves along its epipolar line obeys the fundamental matrix of the first two frames, not the tensor.
    points = follow(scatter(60))
    T, F = MODEL.fit(Correspondences(points)), point_model("fundamental").fit(Correspondences(points[:, :2]))
    line = homogeneous(points[:, 0]) @ F.T
    along = np.stack([line[:, 1], -line[:, 0]], axis=1) / np.linalg.norm(line[:, :2], axis=1, keepdims=True)
    points[:, 1] += 5 * along
    data = Correspondences(points)
    assert point_model("fundamental").residual(F[None], Correspondences(points[:, :2])).max() < 1e-9
    assert np.median(MODEL.residual(T[None], data)) > 0.1


def reason(points, **options):
    return TrifocalDegeneracy(int(type(MODEL)(**options).degeneracy(Correspondences(points))))


def test_cameras_off_a_line_are_not_degenerate(follow, scatter):
    assert reason(follow(scatter(60))) == TrifocalDegeneracy.NONE


@pytest.mark.parametrize(
    "centres",
    [
        ((0.3, 0.05, 0.5), (0.6, 0.1, 1.0)),
        ((0.3, 0.05, 0.5), (-0.3, -0.05, -0.5)),
        ((0, 0, 0.7), (0, 0, 1.5)),
        ((0.3, 0.05, 0.5), (0.3, 0.05, 0.5)),
    ],
    ids=["beyond", "either side", "straight ahead", "second and third at one place"],
)
def test_collinear_camera_centres_are_found(follow, scatter, noisy, centres):
    points = follow(scatter(60), centres=centres)
    assert reason(points) == TrifocalDegeneracy.COLLINEAR_CENTRES
    assert reason(noisy(Correspondences(points), 0.05).points, min_centre_angle=0.05) == (
        TrifocalDegeneracy.COLLINEAR_CENTRES
    )


def test_collinear_centres_still_give_a_tensor_and_may_be_accepted(follow, scatter):
    data = Correspondences(follow(scatter(60), centres=((0, 0, 0.7), (0, 0, 1.5))))
    assert MODEL.residual(MODEL.fit(data)[None], data).max() < 1e-9
    assert MODEL.degenerate(data)
    assert not type(MODEL)(accept_collinear_centres=True).degenerate(data)


def test_centres_a_tenth_off_the_line_are_not_collinear(follow, scatter):
    assert reason(follow(scatter(60), centres=((0, 0, 0.7), (0.15, 0, 1.5)))) == TrifocalDegeneracy.NONE


@pytest.mark.parametrize("num_points", [7, 60])
def test_a_plane_is_degenerate(follow, scatter, num_points):
    points = scatter(num_points)
    points = follow(points * (20 / (points @ [0.2, 0.4, 1.0]))[:, None])
    assert reason(points) == TrifocalDegeneracy.ILL_CONDITIONED
    assert type(MODEL)(accept_collinear_centres=True).degenerate(Correspondences(points))


@pytest.mark.parametrize("centres", [(STILL, STILL), (STILL, (0.5, -0.3, 0.3)), ((0.5, -0.3, 0.3), STILL)])
@pytest.mark.parametrize("num_points", [7, 60])
def test_a_camera_that_only_rotates_from_the_first_frame_is_degenerate(follow, scatter, num_points, centres):
    assert reason(follow(scatter(num_points), centres=centres)) == TrifocalDegeneracy.ILL_CONDITIONED


def test_six_points_are_too_few(follow, scatter):
    assert reason(follow(scatter(6))) == TrifocalDegeneracy.TOO_FEW_POINTS
