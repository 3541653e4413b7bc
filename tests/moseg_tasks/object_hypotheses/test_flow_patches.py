"""Flow models of random patches."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowModelParams, ObjectHypothesisParams
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.motion_models.moments import depth_gauge
from moseg.tasks.motion_models.monomials import image_coordinates
from moseg.tasks.object_hypotheses.flow_patches import (
    block_sums,
    draw_patches,
    flow_patch_residuals,
    solve_patches,
)

PARAMS = ObjectHypothesisParams(num_hypotheses=60, block=4)
FLOW_PARAMS = FlowModelParams()


def residuals(flow, inverse_depth, nodes, model="oc_depth", params=PARAMS, num_nodes=3):
    return flow_patch_residuals(
        flow, inverse_depth, nodes, num_nodes, FLOW_MODELS[model], FLOW_PARAMS, params, np.random.default_rng(3)
    )


def test_some_patches_explain_all_that_rests_and_none_explains_the_mover_too(flow, inverse_depth, owner):
    found = residuals(flow, inverse_depth, owner)
    right = (found[:, 0] < 1e-6) & (found[:, 1] < 1e-6)
    assert right.sum() >= 5
    assert found[right, 2].min() > 0.25


@pytest.mark.parametrize("model", ["oc", "oc_depth", "oc_depth_paper"])
def test_a_patch_of_summed_blocks_is_the_least_squares_fit_to_its_pixels(flow, inverse_depth, model):
    model = FLOW_MODELS[model]
    depth = inverse_depth if model.uses_depth else None
    sums = block_sums(flow, depth, model, 8)
    (theta,) = solve_patches(sums[2:7, 3:9].sum(axis=(0, 1))[None], model, 1e-6)
    rows, columns = slice(16, 56), slice(24, 72)
    x, y = np.meshgrid(*image_coordinates(*flow.shape[:2]))
    rho = np.ones_like(x)
    if depth is not None:
        shift, scale = depth_gauge(depth.astype(np.float64), model)
        rho = (depth - shift) / scale
    design = model.design(*(axis[rows, columns].ravel() for axis in (x, y, rho))).reshape(-1, model.num_parameters)
    expected = np.linalg.lstsq(design, flow[rows, columns].reshape(-1).astype(np.float64))[0]
    np.testing.assert_allclose(design @ theta, design @ expected, atol=1e-6)


def test_residuals_are_mean_squares_over_the_pixels_of_a_node(flow, owner):
    noisy = flow + np.random.default_rng(0).normal(0, 0.3, flow.shape).astype(np.float32)
    model = FLOW_MODELS["oc"]
    patches = draw_patches(block_sums(noisy, None, model, PARAMS.block), PARAMS, np.random.default_rng(3))
    theta = solve_patches(patches, model, FLOW_PARAMS.rank_tolerance)
    x, y = np.meshgrid(*image_coordinates(*flow.shape[:2]))
    design = model.design(x.ravel(), y.ravel(), np.ones(x.size))
    squares = ((np.einsum("ncp,hp->hnc", design, theta) - noisy.reshape(-1, 2)) ** 2).sum(axis=2)
    expected = np.stack([squares[:, owner.ravel() == node].mean(axis=1) for node in range(3)], axis=1)
    np.testing.assert_allclose(residuals(noisy, None, owner, "oc"), expected, rtol=1e-6)


def test_pixels_without_flow_or_depth_are_ignored(flow, inverse_depth, owner):
    holes, deep_holes = flow.copy(), inverse_depth.copy()
    holes[10:30, 10:40] = np.nan
    deep_holes[60:70, :] = np.nan
    known = np.isfinite(holes).all(axis=2) & np.isfinite(deep_holes)
    sums = block_sums(holes, deep_holes, FLOW_MODELS["oc_depth"], 8)
    assert sums[..., 0, 0].sum() == known.sum()
    found = residuals(holes, deep_holes, owner)
    assert np.isfinite(found).all()
    right = found[:, 0] < 1e-6
    assert right.any()
    assert found[right, 1].max() < 1e-6


def test_a_patch_without_pixels_explains_nothing_and_a_node_without_pixels_is_absent(flow, inverse_depth, owner):
    unknown = np.full_like(flow, np.nan)
    unknown[:, :64] = flow[:, :64]
    params = ObjectHypothesisParams(num_hypotheses=200, block=4, min_patch=1)
    found = residuals(unknown, inverse_depth, owner, params=params)
    assert np.isinf(found[:, 0]).any()
    assert np.isfinite(found[:, 0]).any()
    assert np.isnan(found[:, 2]).all()


def test_scale_and_shift_of_inverse_depth_have_no_effect(flow, inverse_depth, owner):
    np.testing.assert_allclose(
        residuals(flow, 3 * inverse_depth + 1, owner), residuals(flow, inverse_depth, owner), rtol=1e-3, atol=1e-6
    )


def test_a_frame_smaller_than_a_patch_is_one_patch(flow, owner):
    params = ObjectHypothesisParams(num_hypotheses=10, block=200, min_patch=3)
    found = residuals(flow, None, owner, "oc", params)
    assert np.ptp(found, axis=0).max() == 0


def test_patches_lie_in_the_frame_at_all_scales():
    sums = np.ones((20, 30, 9, 11))
    sizes = draw_patches(sums, ObjectHypothesisParams(num_hypotheses=4000), np.random.default_rng(0))[:, 0, 0]
    assert sizes.min() >= 1
    assert sizes.max() <= 20 * 30
    below = [(sizes <= area).mean() for area in (4 * 4, 8 * 8)]
    np.testing.assert_allclose(below, [0.3, 0.6], atol=0.12)  # log 4/2 and log 8/2 over log 20/2


def test_an_unknown_node_is_an_error(flow, owner):
    with pytest.raises(InputError):
        residuals(flow, None, owner, "oc", num_nodes=2)
