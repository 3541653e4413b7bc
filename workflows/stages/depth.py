"""Relative inverse depth of a frame."""

import numpy as np

from moseg.schemas.parameters import DepthAnythingParams, DptDinov2Params
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


def _run_dpt_dinov2(params, inputs):
    from moseg.tasks.networks.depth import build_dpt_dinov2

    return _estimate(build_dpt_dinov2, DptDinov2Params.of_recipe(params["dpt_dinov2"]), inputs)


def _run_depth_anything(params, inputs):
    from moseg.tasks.networks.depth import build_depth_anything

    return _estimate(build_depth_anything, DepthAnythingParams.of_recipe(params["depth_anything_v2"]), inputs)


def _estimate(build, depth_params, inputs):
    from moseg.tasks.depth import estimate_inverse_depth

    images = np.stack([each["frame"].cached("image") for each in inputs])
    with open_network(build, inputs[0]["weights"]) as network:
        maps = estimate_inverse_depth(network, images, depth_params)
    return [Output({"inverse_depth": inverse_depth}, made_on()) for inverse_depth in maps]


DPT_DINOV2 = Task("depth", "dpt-dinov2", version=2, run_together=_run_dpt_dinov2)
DEPTH_ANYTHING_V2 = Task("depth", "depth-anything-v2", version=2, run_together=_run_depth_anything)
