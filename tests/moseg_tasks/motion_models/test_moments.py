"""Fits and residuals from moments against direct computation."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowModelParams
from moseg.tasks.motion_models import (
    FLOW_MODELS,
    fit_from_moments,
    flow_energy,
    flow_moments,
    residuals_from_moments,
    unpack_moments,
)
from moseg.tasks.motion_models.moments import depth_gauge
from moseg.tasks.motion_models.monomials import image_coordinates

PARAMS = FlowModelParams()
NUM_OBJECTS = 5


@pytest.fixture
def scene_flow(rigid_flow, motions, inverse_depth, masks):
    """Flow in which each object has a motion of its own, with noise of the given size, float32."""

    def flow(noise: float) -> np.ndarray:
        field = np.zeros((*masks.shape, 2))
        for k, motion in enumerate(motions):
            field[masks == k] = rigid_flow(inverse_depth, *motion)[masks == k]
        return (field + noise * np.random.default_rng(0).normal(size=field.shape)).astype(np.float32)

    return flow


def direct_residuals(flow, inverse_depth, masks, theta, model) -> np.ndarray:
    shift, scale = depth_gauge(inverse_depth if model.uses_depth else None, model)
    x, y = np.meshgrid(*image_coordinates(*masks.shape))
    rho = (inverse_depth.astype(np.float64) - shift) / scale
    residuals = np.full((len(theta), len(theta)), np.nan)
    for data in np.unique(masks):
        own = masks == data
        design = model.design(x[own], y[own], rho[own])
        for k in range(len(theta)):
            residuals[k, data] = ((design @ theta[k] - flow[own]) ** 2).sum(axis=1).mean()
    return residuals


@pytest.mark.parametrize("name", FLOW_MODELS)
@pytest.mark.parametrize(("noise", "rtol"), [(0.0, 1e-8), (1e-3, 1e-9), (0.3, 1e-9)])
def test_residuals_equal_direct_passes(scene_flow, inverse_depth, masks, name, noise, rtol):
    model, flow = FLOW_MODELS[name], scene_flow(noise)
    moments = flow_moments(flow, inverse_depth, masks, NUM_OBJECTS, model, PARAMS)
    theta, valid = fit_from_moments(moments, model, PARAMS)
    residuals = residuals_from_moments(moments, theta, valid)
    assert valid.tolist() == [True, True, False, True, True]
    direct = direct_residuals(flow, inverse_depth, masks, theta, model)
    np.testing.assert_allclose(residuals[valid], np.where(valid, direct, np.nan)[valid], rtol=rtol)


@pytest.mark.parametrize("name", FLOW_MODELS)
def test_fit_is_the_least_squares_solution(scene_flow, inverse_depth, masks, name):
    model, flow = FLOW_MODELS[name], scene_flow(0.3)
    moments = flow_moments(flow, inverse_depth, masks, NUM_OBJECTS, model, PARAMS)
    theta, _ = fit_from_moments(moments, model, PARAMS)
    shift, scale = depth_gauge(inverse_depth if model.uses_depth else None, model)
    x, y = np.meshgrid(*image_coordinates(*masks.shape))
    own = masks == 1
    design = model.design(x[own], y[own], (inverse_depth[own].astype(np.float64) - shift) / scale)
    expected = np.linalg.lstsq(design.reshape(-1, model.num_parameters), flow[own].reshape(-1).astype(np.float64))[0]
    np.testing.assert_allclose(theta[1], expected, rtol=1e-7)


def test_residuals_do_not_depend_on_the_gauge_of_depth(scene_flow, inverse_depth, masks):
    model, flow = FLOW_MODELS["oc_depth"], scene_flow(0.1)

    def residuals(depth):
        moments = flow_moments(flow, depth, masks, NUM_OBJECTS, model, PARAMS)
        return residuals_from_moments(moments, *fit_from_moments(moments, model, PARAMS))

    depth = inverse_depth.astype(np.float64)
    np.testing.assert_allclose(residuals(70.0 * depth + 5.0), residuals(depth), rtol=1e-8)


def test_absent_and_small_objects_are_nan_as_model_and_as_data(scene_flow, inverse_depth, masks):
    params = FlowModelParams(min_pixels=100)  # the thin object has 70
    model = FLOW_MODELS["oc_depth"]
    moments = flow_moments(scene_flow(0.1), inverse_depth, masks, NUM_OBJECTS, model, params)
    theta, valid = fit_from_moments(moments, model, params)
    residuals = residuals_from_moments(moments, theta, valid)
    assert valid.tolist() == [True, True, False, True, False]
    assert not theta[~valid].any()
    np.testing.assert_array_equal(np.isnan(residuals), ~(valid[:, None] & valid[None, :]))
    assert unpack_moments(moments).count.tolist() == [np.count_nonzero(masks == k) for k in range(NUM_OBJECTS)]


def test_energy_is_the_mean_squared_flow(scene_flow, inverse_depth, masks):
    flow = scene_flow(0.1)
    moments = flow_moments(flow, inverse_depth, masks, NUM_OBJECTS, FLOW_MODELS["oc_depth"], PARAMS)
    squared = (flow.astype(np.float64) ** 2).sum(axis=-1)
    expected = [squared[masks == k].mean() if (masks == k).any() else np.nan for k in range(NUM_OBJECTS)]
    np.testing.assert_allclose(flow_energy(moments), expected, rtol=1e-10)


def test_pixels_without_finite_flow_or_depth_are_left_out(scene_flow, inverse_depth, masks):
    flow, depth = scene_flow(0.1), inverse_depth.copy()
    flow[20:25, 30:40] = np.nan
    depth[60, 80:90] = np.inf
    holes = masks.copy()
    holes[20:25, 30:40] = holes[60, 80:90] = 2
    model = FLOW_MODELS["oc_depth"]
    moments = flow_moments(flow, depth, masks, NUM_OBJECTS, model, PARAMS)
    expected = flow_moments(scene_flow(0.1), inverse_depth, holes, NUM_OBJECTS, model, PARAMS)
    others = [0, 1, 3, 4]
    assert unpack_moments(moments).count[others].tolist() == unpack_moments(expected).count[others].tolist()
    residuals = residuals_from_moments(moments, *fit_from_moments(moments, model, PARAMS))
    left = residuals_from_moments(expected, *fit_from_moments(expected, model, PARAMS))
    np.testing.assert_allclose(residuals.diagonal()[others], left.diagonal()[others], rtol=1e-9)


def test_erosion_leaves_out_pixels_near_another_object_but_not_at_the_border(scene_flow, inverse_depth):
    masks = np.zeros(inverse_depth.shape, np.uint16)
    masks[:, :50] = 1
    params = FlowModelParams(erosion=3)
    moments = flow_moments(scene_flow(0.1), inverse_depth, masks, 2, FLOW_MODELS["oc"], params)
    height, width = masks.shape
    assert unpack_moments(moments).count.tolist() == [height * (width - 53), height * 47]


def test_inputs_are_left_as_they_were(scene_flow, inverse_depth, masks):
    flow = scene_flow(0.1)
    flow[0, 0] = np.nan
    inputs = [flow, inverse_depth, masks]
    copies = [array.copy() for array in inputs]
    flow_moments(*inputs, NUM_OBJECTS, FLOW_MODELS["oc_depth"], FlowModelParams(erosion=2))
    for array, copy in zip(inputs, copies, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_an_empty_frame_has_no_valid_model(inverse_depth, masks):
    flow = np.full((*masks.shape, 2), np.nan, np.float32)
    model = FLOW_MODELS["oc_depth"]
    moments = flow_moments(flow, inverse_depth, masks, NUM_OBJECTS, model, PARAMS)
    theta, valid = fit_from_moments(moments, model, PARAMS)
    assert not valid.any()
    assert np.isnan(residuals_from_moments(moments, theta, valid)).all()


def test_bad_input_is_named(inverse_depth, masks):
    flow = np.zeros((*masks.shape, 2), np.float32)
    with pytest.raises(InputError, match="unknown object in masks; got 4; expected ids below 3"):
        flow_moments(flow, inverse_depth, masks, 3, FLOW_MODELS["oc"], PARAMS)
    with pytest.raises(InputError, match="frame sizes disagree"):
        flow_moments(flow[:-1], inverse_depth, masks, NUM_OBJECTS, FLOW_MODELS["oc"], PARAMS)
    with pytest.raises(InputError, match="frame sizes disagree"):
        flow_moments(flow, inverse_depth[:-1], masks, NUM_OBJECTS, FLOW_MODELS["oc_depth"], PARAMS)
