import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.point_models import POINT_MODELS, Correspondences, NoFit, point_model, robust_fit

every_model = pytest.mark.parametrize("model", POINT_MODELS.values(), ids=POINT_MODELS)
SEARCH = {"threshold": 1.0, "num_samples": 600, "num_refits": 5}


@pytest.fixture(scope="session")
def mixed(obey, noisy):
    """Function of a model's name: 200 points, 40 % of them 10 to 40 px off in the last frame, the others' mask."""

    def build(name):
        clean = obey(name, num_points=200, seed=3)
        data = noisy(clean, 0.1)
        rng = np.random.default_rng(4)
        angle, length = rng.uniform(0, 2 * np.pi, 80), rng.uniform(10, 40, 80)
        data.points[:80, -1] += np.stack([np.cos(angle), np.sin(angle)], axis=1) * length[:, None]
        return data, clean.take(np.arange(80, 200)), np.arange(200) >= 80

    return build


@every_model
def test_the_model_is_found_among_two_fifths_of_outliers(model, mixed):
    data, clean, true_mask = mixed(model.name)
    fit = robust_fit(model, data, rng=np.random.default_rng(0), **SEARCH)
    assert fit.reason is None
    assert np.sqrt(np.median(model.residual(fit.parameters[None], clean))) < 0.1
    assert fit.inlier_mask[true_mask].mean() > 0.97
    # An outlier may move along its epipolar line.
    assert fit.inlier_mask[~true_mask].mean() < 0.2


@every_model
def test_equal_seeds_give_equal_bytes(model, mixed):
    data, *_ = mixed(model.name)
    first, second = (robust_fit(model, data, rng=np.random.default_rng(7), **SEARCH) for _ in range(2))
    np.testing.assert_array_equal(first.parameters, second.parameters)
    np.testing.assert_array_equal(first.inlier_mask, second.inlier_mask)


@every_model
def test_too_few_points_have_a_reason(model, obey):
    fit = robust_fit(model, obey(model.name, num_points=2), rng=np.random.default_rng(0), **SEARCH)
    assert fit.parameters is None and fit.reason is NoFit.TOO_FEW_POINTS
    assert fit.inlier_mask.shape == (2,) and not fit.inlier_mask.any()


@every_model
def test_coincident_points_have_a_reason(model, obey):
    data = obey(model.name).take(np.zeros(30, dtype=int))
    fit = robust_fit(model, data, rng=np.random.default_rng(0), **SEARCH)
    assert fit.parameters is None and fit.reason in (NoFit.DEGENERATE, NoFit.NO_MODEL)


@pytest.mark.parametrize("name", ["fundamental", "trifocal"])
def test_a_plane_has_a_reason(name, follow, scatter):
    model, points = point_model(name), scatter(60)
    plane = points * (20 / (points @ [0.2, 0.4, 1.0]))[:, None]
    data = Correspondences(follow(plane)[:, : model.num_frames])
    fit = robust_fit(model, data, rng=np.random.default_rng(0), **SEARCH)
    assert fit.parameters is None and fit.reason in (NoFit.DEGENERATE, NoFit.NO_MODEL)


@every_model
def test_random_points_have_no_model(model, obey):
    data = obey(model.name, num_points=12)
    points = np.random.default_rng(0).uniform(0, 1000, data.points.shape)
    fit = robust_fit(
        model,
        data._replace(points=points),
        rng=np.random.default_rng(0),
        threshold=1e-6,
        num_samples=20,
        num_refits=2,
    )
    # A minimal sample meets its own points; whatever is found has no more.
    assert fit.inlier_mask.sum() <= model.sample_size


@every_model
def test_a_wrong_shape_is_bad_input(model):
    for num_points in (1, 50):
        with pytest.raises(InputError, match="wrong shape"):
            robust_fit(model, Correspondences(np.zeros((num_points, 5, 2))), rng=np.random.default_rng(0), **SEARCH)


def test_more_than_one_point_set_is_bad_input(obey):
    data = obey("affine")
    with pytest.raises(InputError, match="more than one"):
        robust_fit(
            point_model("affine"), data._replace(points=data.points[None]), rng=np.random.default_rng(0), **SEARCH
        )
