import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry import ModelKind, fit_fundamentals, fundamental_residuals

ESTIMATORS = ["eight_point_ransac", "poselib"]
LEFT, RIGHT = ((0, 250), (0, 479)), ((600, 853), (0, 479))


@pytest.fixture
def scene(see, scatter):
    """A background (0) under camera motion, a mover (1), a static object (2), two points (3), and no point of 4."""
    parts = [
        see(scatter(80)),
        see(scatter(30, seed=1, near=4, far=7, pixels=LEFT), translation=(-0.2, 0.4, 0.1)),
        see(scatter(30, seed=2, near=4, far=7, pixels=RIGHT)),
        see(scatter(2, seed=3)),
    ]
    points0, points1 = (np.concatenate([part[side] for part in parts]) for side in (0, 1))
    return points0, points1, np.repeat(np.arange(4), [80, 30, 30, 2]).astype(np.uint16)


@pytest.fixture
def fit(image_shape):
    def fit(points0, points1, object, num_objects=5, seed=0, **params):
        rng = np.random.default_rng(seed)
        return fit_fundamentals(points0, points1, object, num_objects, FundamentalParams(**params), rng, image_shape)

    return fit


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_exact_tracks_leave_no_residual_but_for_the_mover(scene, fit, estimator):
    fits = fit(*scene, estimator=estimator)
    residual = fundamental_residuals(fits, *scene, FundamentalParams())
    np.testing.assert_array_equal(fits.valid, [True, True, True, False, False])
    assert np.diag(residual)[:3].max() < 1e-9
    assert max(residual[0, 2], residual[2, 0]) < 1e-9
    assert min(residual[0, 1], residual[1, 0], residual[1, 2], residual[2, 1]) > 4


def test_what_is_not_valid_is_zero_and_nan(scene, fit):
    fits = fit(*scene)
    residual = fundamental_residuals(fits, *scene, FundamentalParams())
    assert (fits.F[3:] == 0).all()
    assert (fits.kind == [ModelKind.FUNDAMENTAL] * 3 + [ModelKind.NONE] * 2).all()
    assert np.isnan(residual[3:]).all() and np.isnan(residual[:, 3:]).all()
    assert np.isfinite(residual[:3, :3]).all()
    np.testing.assert_array_equal(fits.counts[:, 0], [80, 30, 30, 2, 0])


@pytest.mark.parametrize(("min_points", "is_known"), [(30, True), (31, False)])
def test_an_object_with_just_enough_points_has_residuals(scene, fit, min_points, is_known):
    residual = fundamental_residuals(fit(*scene), *scene, FundamentalParams(min_points=min_points))
    assert np.isfinite(residual[:3, 1:3]).all() == is_known


def test_swapping_the_frames_transposes(scene, fit):
    points0, points1, object = scene
    forward, backward = fit(points0, points1, object), fit(points1, points0, object)
    np.testing.assert_allclose(forward.F[:3], np.swapaxes(backward.F[:3], 1, 2), atol=1e-8)


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_equal_generators_give_equal_bytes(scene, fit, estimator):
    first, second = (fit(*scene, estimator=estimator) for _ in range(2))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(first, second, strict=True))


def test_the_fit_of_an_object_does_not_depend_on_the_others(scene, fit):
    points0, points1, object = scene
    mover = object == 1
    alone = fit(points0[mover], points1[mover], object[mover])
    np.testing.assert_array_equal(alone.F[1], fit(*scene).F[1])


def test_inputs_are_left_as_they_were(scene, fit):
    copies = [array.copy() for array in scene]
    fundamental_residuals(fit(*scene), *scene, FundamentalParams())
    for array, copy in zip(scene, copies, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_the_median_is_robust_to_a_mistracked_point(scene, fit):
    points0, points1, object = scene
    fits = fit(*scene)
    points1 = points1.copy()
    points1[:8] += 100
    median, mean = (
        fundamental_residuals(fits, points0, points1, object, FundamentalParams(statistic=name))[0, 0]
        for name in ("median", "mean")
    )
    assert median < 1e-9
    assert mean > 10


class TestWithoutParallax:
    """A turning camera: a homography explains the background, and its fundamental matrix is arbitrary."""

    @pytest.fixture
    def turning(self, see, scatter):
        still = {"translation": (0, 0, 0), "rotation_deg": (0, 2, 0)}
        parts = [
            see(scatter(80), **still),
            see(scatter(30, seed=1, near=4, far=7, pixels=LEFT), translation=(0.1, 0.0, 0.0), rotation_deg=(0, 2, 0)),
            see(scatter(30, seed=2, near=4, far=7, pixels=RIGHT), **still),
        ]
        points0, points1 = (np.concatenate([part[side] for part in parts]) for side in (0, 1))
        return points0, points1, np.repeat(np.arange(3), [80, 30, 30]).astype(np.uint16)

    def test_homographies_separate_the_mover(self, turning, fit):
        fits = fit(*turning, num_objects=3)
        residual = fundamental_residuals(fits, *turning, FundamentalParams())
        assert fits.kind[0] == fits.kind[2] == ModelKind.HOMOGRAPHY
        assert max(residual[0, 0], residual[0, 2], residual[2, 0]) < 1e-9
        assert residual[0, 1] > 30

    def test_a_kept_fundamental_matrix_explains_more_than_a_homography(self, turning, fit):
        kept = fundamental_residuals(fit(*turning, num_objects=3, degenerate="keep"), *turning, FundamentalParams())
        replaced = fundamental_residuals(fit(*turning, num_objects=3), *turning, FundamentalParams())
        assert kept[0, 1] < replaced[0, 1] / 2

    def test_discarded_fits_are_not_valid(self, turning, fit):
        fits = fit(*turning, num_objects=3, degenerate="discard")
        np.testing.assert_array_equal(fits.valid[[0, 2]], False)
        assert (fits.F[[0, 2]] == 0).all()
        assert (fits.counts[[0, 2], 2] >= 30).all()


def test_a_plane_before_a_background_with_parallax_keeps_its_fundamental_matrix(see, scatter, fit):
    plane = scatter(30, seed=1, near=5, far=5, pixels=LEFT)
    views = see(np.concatenate([scatter(80), plane]))
    object = np.repeat(np.arange(2), [80, 30]).astype(np.uint16)
    assert (fit(views.points0, views.points1, object, num_objects=2).kind == ModelKind.FUNDAMENTAL).all()


def test_no_tracks_and_no_objects(fit):
    empty = np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.uint16)
    fits = fit(*empty, num_objects=3)
    assert not fits.valid.any()
    assert fits.counts.shape == (3, 3)
    assert np.isnan(fundamental_residuals(fits, *empty, FundamentalParams())).all()
    none = fit(*empty, num_objects=0)
    assert none.F.shape == (0, 3, 3) and none.counts.shape == (0, 3)
    assert fundamental_residuals(none, *empty, FundamentalParams()).shape == (0, 0)


def test_arrays_that_disagree_are_refused(scene, fit):
    points0, points1, object = scene
    with pytest.raises(InputError, match=r"points1; got \(141, 2\); expected \(142, 2\)"):
        fit(points0, points1[:-1], object)
    with pytest.raises(InputError, match="object; got 3; expected below 3"):
        fit(*scene, num_objects=3)
    with pytest.raises(InputError, match="points0"):
        fundamental_residuals(fit(*scene), points0[:3], points1, object, FundamentalParams())
