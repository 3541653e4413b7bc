import numpy as np
import pytest

from moseg.tasks.geometry.poselib_fundamental import poselib_fundamental
from moseg.tasks.geometry.ransac import FUNDAMENTAL, HOMOGRAPHY, ModelFamily, draw_samples, ransac
from moseg.tasks.geometry.sampson import sampson_squared

SETTINGS = {"threshold": 1.0, "num_samples": 300, "num_refits": 5}


@pytest.fixture
def polluted(see, scatter):
    """60 pairs of which the first 20 are wrong, with a tenth of a pixel of noise."""
    views = see(scatter(60))
    rng = np.random.default_rng(1)
    points1 = views.points1 + rng.normal(0, 0.1, views.points1.shape)
    points1[:20] += rng.uniform(20, 60, (20, 2)) * rng.choice([-1, 1], (20, 2))
    return views.points0, points1, views.F


def test_wrong_pairs_are_left_out(polluted):
    points0, points1, F = polluted
    fit = ransac(FUNDAMENTAL, points0, points1, rng=np.random.default_rng(0), **SETTINGS)
    assert fit.inlier_mask[20:].all()
    # A wrong pair may lie on its epipolar line by chance.
    assert fit.inlier_mask[:20].mean() < 0.2
    true_pairs = points0[20:], points1[20:]
    assert np.median(sampson_squared(fit.matrix, *true_pairs)) < 2 * np.median(sampson_squared(F, *true_pairs))


def test_refits_lower_the_cost(polluted):
    points0, points1, _ = polluted

    def cost(num_refits):
        settings = SETTINGS | {"num_refits": num_refits}
        fit = ransac(FUNDAMENTAL, points0, points1, rng=np.random.default_rng(0), **settings)
        return np.minimum(sampson_squared(fit.matrix, points0, points1), 1).sum()

    assert cost(5) < cost(0)


def test_only_the_seed_changes_the_result(polluted):
    points0, points1, _ = polluted
    # Without refits, for these lead from different samples to one and the same set of inliers.
    settings = SETTINGS | {"num_refits": 0}
    first, again, other = (
        ransac(FUNDAMENTAL, points0, points1, rng=np.random.default_rng(seed), **settings).matrix.tobytes()
        for seed in (7, 7, 8)
    )
    assert first == again != other


def test_a_homography_is_found_among_wrong_pairs():
    rng = np.random.default_rng(0)
    points0 = rng.uniform(0, 800, (40, 2))
    points1 = points0 * 1.05 + [4, -2]
    points1[:15] += 50 * rng.normal(size=(15, 2))
    fit = ransac(HOMOGRAPHY, points0, points1, rng=rng, **SETTINGS)
    np.testing.assert_array_equal(fit.inlier_mask, np.arange(40) >= 15)


def test_samples_repeat_no_point():
    samples = draw_samples(9, 8, 200, np.random.default_rng(0))
    assert (np.diff(np.sort(samples, axis=1), axis=1) > 0).all()
    assert set(samples.ravel()) == set(range(9))
    assert draw_samples(8, 8, 3, np.random.default_rng(0)).shape == (3, 8)


def test_poselib_is_seeded_by_the_generator(polluted):
    points0, points1, _ = polluted
    fits = [
        poselib_fundamental(points0, points1, threshold=1.0, num_samples=200, rng=np.random.default_rng(3))
        for _ in range(2)
    ]
    assert fits[0].matrix.tobytes() == fits[1].matrix.tobytes()
    assert fits[0].inlier_mask[20:].all()


def test_poselib_without_a_model_returns_none():
    points = np.full((8, 2), 0.5)
    assert poselib_fundamental(points, points, threshold=0.01, num_samples=20, rng=np.random.default_rng(0)) is None


def test_a_refit_that_costs_more_is_not_kept():
    """A solver that is exact for one pair and wrong by half a pixel for several."""

    def solve(points0, points1):
        shifts = (points1 - points0).mean(axis=-2)
        return shifts + 0.5 * (points0.shape[-2] > 1)

    def distance_squared(shifts, points0, points1):
        return ((points1 - points0 - shifts[..., None, :]) ** 2).sum(axis=-1)

    points0 = np.random.default_rng(0).uniform(0, 100, (30, 2))
    family = ModelFamily(1, solve, distance_squared)
    fit = ransac(family, points0, points0 + np.array([3, 1]), rng=np.random.default_rng(1), **SETTINGS)
    np.testing.assert_allclose(fit.matrix, [3, 1], atol=1e-12)
