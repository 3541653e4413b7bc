import numpy as np
import pytest

from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry import Degeneracy, fit_fundamentals


@pytest.fixture
def reason_of(image_shape):
    def reason(points0, points1, **params):
        fits = fit_fundamentals(
            points0,
            points1,
            np.zeros(len(points0), np.uint16),
            1,
            FundamentalParams(**params),
            np.random.default_rng(0),
            image_shape,
        )
        return Degeneracy(fits.reason[0])

    return reason


def noisy(points, seed=9, sigma=0.05):
    return points + np.random.default_rng(seed).normal(0, sigma, points.shape)


def test_points_spread_in_space_are_not_degenerate(reason_of, see, scatter):
    views = see(scatter(40))
    assert reason_of(views.points0, noisy(views.points1)) == Degeneracy.NONE


def test_seven_points_are_too_few(reason_of, see, scatter):
    views = see(scatter(7))
    assert reason_of(views.points0, views.points1) == Degeneracy.TOO_FEW_POINTS


def test_a_plane_is_explained_by_a_homography(reason_of, see, scatter):
    points = scatter(40)
    points = points * (8 / (points @ [0.2, 0.1, 1.0]))[:, None]
    views = see(points)
    assert reason_of(views.points0, noisy(views.points1)) == Degeneracy.HOMOGRAPHY


def test_a_pure_rotation_is_explained_by_a_homography(reason_of, see, scatter):
    views = see(scatter(40), translation=(0, 0, 0), rotation_deg=(0, 3, 1))
    assert reason_of(views.points0, noisy(views.points1)) == Degeneracy.HOMOGRAPHY


def test_a_still_camera_is_explained_by_a_homography(reason_of, see, scatter):
    views = see(scatter(40), translation=(0, 0, 0), rotation_deg=(0, 0, 0))
    assert reason_of(views.points0, views.points0) == Degeneracy.HOMOGRAPHY
    assert reason_of(views.points0, noisy(views.points0)) == Degeneracy.HOMOGRAPHY


def test_points_on_a_line_are_collinear(reason_of, see):
    along = np.linspace(0, 1, 30)[:, None]
    views = see(np.array([-2.0, -1.0, 4.0]) + along * np.array([5.0, 2.0, 6.0]))
    assert reason_of(views.points0, noisy(views.points1)) == Degeneracy.COLLINEAR


def test_a_plane_and_one_point_leave_a_family_of_solutions(reason_of, see, scatter):
    points = scatter(11)
    points[1:] *= (8 / points[1:, 2])[:, None]
    views = see(points)
    assert reason_of(views.points0, views.points1) == Degeneracy.ILL_CONDITIONED


@pytest.mark.parametrize("estimator", ["eight_point_ransac", "poselib"])
def test_unrelated_points_have_no_model(reason_of, estimator):
    points0, points1 = np.random.default_rng(0).uniform(0, 480, (2, 12, 2))
    assert reason_of(points0, points1, threshold=1e-3, estimator=estimator) == Degeneracy.NO_MODEL


def test_as_many_points_as_required_are_enough(reason_of, see, scatter):
    views = see(scatter(8))
    assert reason_of(views.points0, views.points1) != Degeneracy.TOO_FEW_POINTS


def test_points_on_a_line_in_one_frame_are_collinear(reason_of, see, scatter):
    points = scatter(40)
    points[:, 1] = 0
    views = see(points, translation=(0, 1, 0), rotation_deg=(0, 0, 0))
    assert reason_of(views.points0, views.points1) == Degeneracy.COLLINEAR
