"""What every point model must do, and a check that every registered model is here."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.tasks.geometry.ransac import draw_samples
from moseg.tasks.point_models import POINT_MODELS, Correspondences, point_model

every_model = pytest.mark.parametrize("model", POINT_MODELS.values(), ids=POINT_MODELS)
properties = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 2**31)


def samples_of(model, data, num_samples=40, seed=0):
    rng = np.random.default_rng(seed)
    return data.take(draw_samples(data.num_points, model.sample_size, num_samples, rng))


def test_an_unknown_name_is_bad_input():
    with pytest.raises(InputError, match="affine"):
        point_model("quadrifocal")


@every_model
def test_a_model_is_found_by_its_name(model):
    assert point_model(model.name) is model


@every_model
@properties
@given(seed=seeds)
def test_least_squares_without_noise_leave_no_residual(model, obey, seed):
    data = obey(model.name, seed=seed)
    assert model.residual(model.fit(data)[None], data).max() < 1e-9
    assert not model.degenerate(data)


@every_model
@properties
@given(seed=seeds)
def test_minimal_fits_without_noise_leave_no_residual(model, obey, seed):
    data = obey(model.name, seed=seed)
    samples = samples_of(model, data, seed=seed)
    determined = ~model.degenerate(samples)
    assert determined.mean() > 0.5
    residual = model.residual(model.fit(samples)[determined], data)
    assert residual.max() < 1e-9


@every_model
def test_points_of_another_motion_have_residuals(model, obey):
    parameters = model.fit(obey(model.name, seed=0))
    moved = obey(model.name, seed=0)
    moved.points[:, -1] += [3.0, 4.0]
    assert np.median(model.residual(parameters[None], moved)) > 0.1


@every_model
def test_noise_of_one_pixel_leaves_residuals_of_its_size(model, obey, noisy):
    data = noisy(obey(model.name, num_points=400), 1.0)
    residual = model.residual(model.fit(data)[None], data)
    assert 0.3 < residual.mean() < 4


@every_model
@properties
@given(seed=seeds)
def test_a_batch_gives_what_a_loop_gives(model, obey, noisy, seed):
    data = noisy(obey(model.name, seed=seed), 0.5, seed)
    samples = samples_of(model, data, 12, seed)
    singles = [samples._replace(points=p, inverse_depth=d) for p, d in each(samples)]
    parameters = model.fit(samples)
    looped = np.stack([model.fit(single) for single in singles])
    residual = model.residual(parameters, data)
    assert parameters.dtype == residual.dtype == np.float64
    assert residual.shape == (12, data.num_points)
    # A poorly determined sample turns rounding into another model.
    determined = ~model.degenerate(samples)
    np.testing.assert_array_equal(determined, [not model.degenerate(single) for single in singles])
    looped_residual = np.concatenate([model.residual(one[None], data) for one in looped])
    np.testing.assert_allclose(residual[determined], looped_residual[determined], rtol=1e-5, atol=1e-7)


def each(samples):
    depths = [None] * len(samples.points) if samples.inverse_depth is None else samples.inverse_depth
    return zip(samples.points, depths, strict=True)


@every_model
def test_leading_dimensions_broadcast(model, obey, noisy):
    sets = [noisy(obey(model.name, seed=seed), 0.5) for seed in range(3)]
    depth = None if sets[0].inverse_depth is None else np.stack([s.inverse_depth for s in sets])
    stacked = sets[0]._replace(points=np.stack([s.points for s in sets]), inverse_depth=depth)
    parameters = np.stack([model.fit(samples_of(model, s, 5)) for s in sets])
    expected = np.stack([model.residual(p, s) for p, s in zip(parameters, sets, strict=True)])
    np.testing.assert_allclose(model.residual(parameters, stacked), expected, rtol=1e-7, atol=1e-9)
    assert model.fit(stacked).shape == (3, *parameters.shape[2:])
    assert model.degenerate(stacked).shape == (3,)


@every_model
def test_blocks_of_models_do_not_change_the_residuals(model, obey, noisy):
    data = noisy(obey(model.name, num_points=2000), 0.5)
    parameters = model.fit(samples_of(model, data, 70))
    whole = model.residual(parameters, data)
    parts = [model.residual(parameters[i : i + 7], data) for i in range(0, 70, 7)]
    # The points of a fit are on its model but for rounding: squared distances that small have no equal digits.
    np.testing.assert_allclose(whole, np.concatenate(parts), rtol=1e-9, atol=1e-18)


@every_model
@properties
@given(seed=seeds)
def test_the_order_of_the_points_does_not_matter(model, obey, noisy, seed):
    data = noisy(obey(model.name, seed=seed), 0.5, seed)
    order = np.random.default_rng(seed).permutation(data.num_points)
    shuffled = data.take(order)
    residual = model.residual(model.fit(data)[None], data)
    np.testing.assert_allclose(
        model.residual(model.fit(shuffled)[None], shuffled), residual[:, order], rtol=1e-5, atol=1e-7
    )


@every_model
@properties
@given(seed=seeds, scale=st.floats(0.1, 10))
def test_distances_scale_with_the_image(model, obey, noisy, seed, scale):
    data = noisy(obey(model.name, seed=seed), 0.5, seed)
    centre = None if data.principal_point is None else tuple(scale * np.asarray(data.principal_point))
    larger = data._replace(points=scale * data.points, principal_point=centre)
    residual = model.residual(model.fit(data)[None], data)
    np.testing.assert_allclose(
        model.residual(model.fit(larger)[None], larger), scale**2 * residual, rtol=1e-5, atol=1e-7 * scale**2
    )
    assert model.degenerate(larger) == model.degenerate(data)


@every_model
def test_single_precision_is_within_a_thousandth_above_a_twentieth_of_a_pixel(model, obey, noisy):
    data = noisy(obey(model.name, num_points=500), 0.3)
    samples = samples_of(model, data, 300)
    parameters = model.fit(samples)[~model.degenerate(samples)]
    exact = model.residual(parameters, data)
    single = model.residual(parameters, data, np.float32)
    assert single.dtype == np.float32
    above = exact > 0.05**2
    difference = np.abs(single[above] - exact[above]) / exact[above]
    # Beside the line that a homography sends to infinity nothing is within a thousandth.
    assert np.quantile(difference, 0.9999) < 1e-3


@every_model
def test_too_few_points_are_degenerate_and_cannot_be_fitted(model, obey):
    data = obey(model.name, num_points=model.sample_size - 1)
    assert model.degenerate(data)
    with pytest.raises(InputError, match="too few points"):
        model.fit(data)


@every_model
def test_coincident_points_are_degenerate_and_stay_finite(model, obey):
    data = obey(model.name, num_points=20)
    same = data.take(np.zeros(20, dtype=int))
    assert model.degenerate(same)
    for points in (same, same.take(np.arange(model.sample_size))):
        parameters = model.fit(points)
        assert np.isfinite(parameters).all()
        assert np.isfinite(model.residual(parameters[None], data)).all()


@every_model
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("kind", ["line", "level line", "still", "shifted", "all at the origin"])
def test_degenerate_samples_never_explain_every_point(model, obey, noisy, kind, dtype):
    data = noisy(obey(model.name), 0.5)
    rng = np.random.default_rng(0)
    size = (50, model.sample_size, model.num_frames)
    along = rng.uniform(0, 300, (*size[:2], 1, 1))
    pixels = np.repeat(rng.uniform(0, 1000, (*size[:2], 1, 2)), model.num_frames, axis=2)
    points = {
        "line": [100.0, 50.0] + along * [1.0, 0.3] + np.zeros((*size, 2)),
        "level line": np.stack([rng.uniform(0, 1000, size), np.full(size, 7.0)], axis=-1),
        "still": pixels,
        "shifted": pixels + np.arange(model.num_frames)[:, None] * [3.0, 1.0],
        "all at the origin": np.zeros((*size, 2)),
    }[kind]
    samples = Correspondences(points, np.full(size[:2], 0.5), (620.5, 187.0))
    parameters = model.fit(samples)
    assert np.isfinite(parameters).all()
    if kind not in ("still", "shifted") or model.sample_size > 6:
        assert model.degenerate(samples).all()
    residual = model.residual(parameters, data, dtype)
    assert np.isfinite(residual).all()
    assert (np.median(residual, axis=1) > 0).all()


@every_model
def test_a_sample_with_the_same_point_twice_is_degenerate(model, obey):
    index = np.arange(model.sample_size)
    index[-1] = 0
    assert model.degenerate(obey(model.name).take(index))


@every_model
def test_collinear_points_are_degenerate(model, follow, obey):
    along = np.random.default_rng(0).uniform(-1, 1, (30, 1))
    points = follow(along * [3.0, 1.0, 2.0] + [0.0, 0.0, 15.0])[:, : model.num_frames]
    constant = np.ones(30)
    assert model.degenerate(Correspondences(points, constant, (620.5, 187.0)))


@every_model
@pytest.mark.parametrize("shape", [(20, 2), (20, 4, 2), (20, 2, 3), (20, 3, 3)])
def test_a_wrong_shape_is_bad_input(model, shape):
    data = Correspondences(np.zeros(shape), np.zeros(20), (0.0, 0.0))
    for use in (model.fit, model.degenerate, lambda data: model.residual(np.zeros((1, 3, 3)), data)):
        with pytest.raises(InputError, match="wrong shape"):
            use(data)


@every_model
def test_the_input_is_left_as_it_was(model, obey):
    data = obey(model.name)
    before = data.points.copy()
    samples = samples_of(model, data)
    parameters = model.fit(samples)
    kept = parameters.copy()
    model.residual(parameters, data)
    model.degenerate(samples)
    np.testing.assert_array_equal(data.points, before)
    np.testing.assert_array_equal(parameters, kept)


@every_model
def test_no_points_and_no_models_are_allowed(model, obey):
    data = obey(model.name)
    parameters = model.fit(samples_of(model, data, 3))
    assert model.residual(parameters, data.take(np.zeros(60, dtype=bool))).shape == (3, 0)
    assert model.residual(parameters[:0], data).shape == (0, 60)


@every_model
def test_points_on_a_line_leave_no_residual_unknown(model):
    rng = np.random.default_rng(0)
    along = rng.uniform(0, 400, (60, 1, 1)) * np.array([1.0, 0.37])
    points = along + np.arange(model.num_frames)[:, None] * [3.0, 1.0] + [20.0, 30.0]
    points[:, 1:] += rng.normal(0, 0.3, points[:, 1:].shape)
    data = Correspondences(points, np.full(60, 0.5), (200.0, 80.0))
    with np.errstate(invalid="raise", divide="raise"):
        parameters = model.fit(samples_of(model, data, 300))
        residuals = model.residual(parameters[np.isfinite(parameters.reshape(300, -1)).all(axis=1)], data)
    assert (residuals >= 0).all()
