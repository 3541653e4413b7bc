"""What each flow model can express."""

import numpy as np
import pytest

from moseg.schemas.parameters import FlowModelParams
from moseg.tasks.motion_models import (
    FLOW_MODELS,
    fit_from_moments,
    flow_energy,
    flow_moments,
    residuals_from_moments,
)

PARAMS = FlowModelParams()
MOTION = ((0.1, -0.05, 0.2), (0.01, -0.02, 0.03))


def unexplained(flow, inverse_depth, name) -> float:
    """Root of the share of one object's flow energy that its own fit leaves."""
    masks = np.zeros(flow.shape[:2], np.uint16)
    moments = flow_moments(flow, inverse_depth, masks, 1, FLOW_MODELS[name], PARAMS)
    residual = residuals_from_moments(moments, *fit_from_moments(moments, FLOW_MODELS[name], PARAMS))
    return float(np.sqrt(residual[0, 0] / flow_energy(moments)[0]))


@pytest.mark.parametrize(("name", "size"), [("oc_depth", 9), ("oc_depth_paper", 8), ("oc", 12)])
def test_number_of_parameters(name, size):
    assert FLOW_MODELS[name].num_parameters == size


def test_oc_depth_holds_rigid_motion_exactly(rigid_flow, inverse_depth):
    flow = rigid_flow(inverse_depth, *MOTION)
    assert unexplained(flow, inverse_depth, "oc_depth") < 1e-12
    assert unexplained(flow.astype(np.float32), inverse_depth, "oc_depth") < 1e-6


def test_oc_depth_holds_a_zooming_camera_exactly(rigid_flow, inverse_depth):
    assert unexplained(rigid_flow(inverse_depth, *MOTION, zoom=0.03), inverse_depth, "oc_depth") < 1e-12


@pytest.mark.parametrize(("scale", "shift"), [(4.0, 0.0), (1.0, 0.7), (250.0, -30.0)])
def test_oc_depth_needs_depth_only_up_to_scale_and_shift(rigid_flow, inverse_depth, scale, shift):
    flow = rigid_flow(inverse_depth, *MOTION)
    assert unexplained(flow, scale * inverse_depth.astype(np.float64) + shift, "oc_depth") < 1e-11


def test_printed_signs_do_not_hold_rigid_motion(rigid_flow, inverse_depth):
    assert unexplained(rigid_flow(inverse_depth, *MOTION), inverse_depth, "oc_depth_paper") > 0.05


def test_printed_form_does_not_allow_a_shift_of_depth(rigid_flow, inverse_depth):
    forward = rigid_flow(inverse_depth, (0.0, 0.0, 0.3), (0.0, 0.0, 0.0))
    assert unexplained(forward, inverse_depth, "oc_depth_paper") < 1e-12
    assert unexplained(forward, inverse_depth + 1.0, "oc_depth_paper") > 0.01


def test_quadratic_model_holds_a_plane_but_not_parallax(rigid_flow, inverse_depth):
    y = np.linspace(-1, 1, inverse_depth.shape[0])[:, None]
    plane = np.broadcast_to(0.3 + 0.2 * y, inverse_depth.shape)
    assert unexplained(rigid_flow(plane, *MOTION), None, "oc") < 1e-12
    assert unexplained(rigid_flow(inverse_depth, *MOTION), None, "oc") > 0.05


@pytest.mark.parametrize("name", ["oc_depth", "oc_depth_paper"])
def test_no_depth_is_a_constant_depth(rigid_flow, inverse_depth, name):
    flow = rigid_flow(inverse_depth, *MOTION)
    expected = unexplained(flow, np.ones_like(inverse_depth), name)
    assert unexplained(flow, None, name) == pytest.approx(expected, rel=1e-9)


def test_without_depth_a_front_on_plane_is_exact_and_the_fit_is_the_shortest(rigid_flow, inverse_depth):
    flow = rigid_flow(np.ones_like(inverse_depth), *MOTION)
    assert unexplained(flow, None, "oc_depth") < 1e-12
    moments = flow_moments(flow, None, np.zeros(flow.shape[:2], np.uint16), 1, FLOW_MODELS["oc_depth"], PARAMS)
    theta, _ = fit_from_moments(moments, FLOW_MODELS["oc_depth"], PARAMS)
    a, b, c, *_, k = theta[0]
    assert (a, c) == (pytest.approx(b), pytest.approx(k))
