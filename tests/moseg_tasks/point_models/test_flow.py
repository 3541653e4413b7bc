import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.point_models import POINT_MODELS, Correspondences, point_model
from moseg.tasks.point_models.flow import FlowPointModel

flow_models = pytest.mark.parametrize("name", ["oc", "oc_depth"])


def test_samples_are_as_small_as_the_parameters_allow():
    assert {name: POINT_MODELS[name].sample_size for name in ("oc", "oc_depth")} == {"oc": 6, "oc_depth": 5}


@flow_models
def test_the_residual_is_the_squared_displacement_error(name, obey, noisy):
    clean = obey(name)
    data = noisy(clean, 1.0)
    data.points[:, 0] = clean.points[:, 0]
    model = point_model(name)
    expected = np.sum((data.points[:, 1] - clean.points[:, 1]) ** 2, axis=1)
    np.testing.assert_allclose(model.residual(model.fit(clean)[None], data)[0], expected, rtol=1e-7)


@flow_models
def test_least_squares_agree_with_the_design_of_the_flow_model(name, obey, noisy):
    data = noisy(obey(name), 1.0)
    x, y = (data.points[:, 0] - data.principal_point).T
    design = FLOW_MODELS[name].design(x, y, data.inverse_depth)
    target = (data.points[:, 1] - data.points[:, 0]).reshape(-1)
    columns = np.linalg.norm(design, axis=(0, 1))
    expected = np.linalg.lstsq((design / columns).reshape(len(target), -1), target)[0] / columns
    np.testing.assert_allclose(point_model(name).fit(data), expected, rtol=1e-6)


def test_the_quadratic_model_asks_for_no_principal_point(obey, noisy):
    model, data = point_model("oc"), noisy(obey("oc"), 1.0)
    bare = Correspondences(data.points)
    residual = model.residual(model.fit(data)[None], data)
    np.testing.assert_allclose(model.residual(model.fit(bare)[None], bare), residual, rtol=1e-6)


def test_the_unknown_shift_of_inverse_depth_does_not_matter(obey, noisy):
    model, data = point_model("oc_depth"), noisy(obey("oc_depth"), 1.0)
    shifted = data._replace(inverse_depth=3 * data.inverse_depth + 2)
    residual = model.residual(model.fit(data)[None], data)
    np.testing.assert_allclose(model.residual(model.fit(shifted)[None], shifted), residual, rtol=1e-6)


def test_a_conic_is_degenerate_without_depth(obey):
    data = obey("oc")
    angle = np.linspace(0, 6, 60)
    data.points[:, 0] = np.stack([300 * np.cos(angle), 100 * np.sin(angle)], axis=1) + data.principal_point
    assert point_model("oc").degenerate(data)


def test_constant_depth_is_degenerate_with_depth(obey):
    data = obey("oc_depth")
    assert point_model("oc_depth").degenerate(data._replace(inverse_depth=np.full(60, 0.5)))


@pytest.mark.parametrize("missing", ["inverse_depth", "principal_point"])
def test_depth_and_principal_point_are_asked_for(obey, missing):
    data = obey("oc_depth")._replace(**{missing: None})
    for use in (point_model("oc_depth").fit, point_model("oc_depth").degenerate):
        with pytest.raises(InputError, match=missing):
            use(data)


def test_depth_of_another_length_is_bad_input(obey):
    data = obey("oc_depth")
    with pytest.raises(InputError, match="inverse_depth"):
        point_model("oc_depth").fit(data._replace(inverse_depth=data.inverse_depth[1:]))


def test_any_flow_model_can_be_used(obey, noisy):
    model = FlowPointModel(FLOW_MODELS["oc_depth_paper"])
    data = noisy(obey("oc_depth"), 0.1)
    assert model.name == "oc_depth_paper" and model.sample_size == 4
    assert (
        model.residual(model.fit(data)[None], data).mean()
        > point_model("oc_depth").residual(point_model("oc_depth").fit(data)[None], data).mean()
    )
