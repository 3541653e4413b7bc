"""Depth: relative inverse depth of a frame."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import DepthAnything3Params, DepthAnythingParams, DptDinov2Params
from moseg.workflows.stages.image_sizes import run_by_image_size
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import TRANSFORMERS, Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task


def _run_dpt_dinov2(params, inputs):
    from moseg.tasks.networks.depth import build_dpt_dinov2

    return _estimate(build_dpt_dinov2, DptDinov2Params.of_recipe(params["dpt_dinov2"]), inputs)


def _run_depth_anything(params, inputs):
    from moseg.tasks.networks.depth import build_depth_anything

    return _estimate(build_depth_anything, DepthAnythingParams.of_recipe(params["depth_anything_v2"]), inputs)


def _run_depth_anything_3(params, inputs):
    from moseg.tasks.networks.depth_anything_3 import build_depth_anything_3

    return _estimate(build_depth_anything_3, DepthAnything3Params.of_recipe(params["depth_anything_3"]), inputs)


def _estimate(build, depth_params, inputs):
    from moseg.tasks.depth import estimate_inverse_depth

    with open_network(build, inputs[0]["weights"]) as network:
        maps = run_by_image_size(
            lambda images: estimate_inverse_depth(network, *images, depth_params), inputs, ("frame",)
        )
    return [Output({"inverse_depth": inverse_depth}, made_on()) for inverse_depth in maps]


def _dpt_dinov2_params(config: PipelineConfig) -> dict:
    return {"dpt_dinov2": config.dpt_dinov2.model_dump(mode="json", exclude={"weights"})}


def _depth_anything_params(config: PipelineConfig) -> dict:
    return {"depth_anything_v2": config.depth_anything_v2.model_dump(mode="json", exclude={"weights"})}


def _depth_anything_3_params(config: PipelineConfig) -> dict:
    return {"depth_anything_3": config.depth_anything_3.model_dump(mode="json", exclude={"weights"})}


DPT_DINOV2 = Task(
    "depth",
    "dpt-dinov2",
    version=2,
    run_together=_run_dpt_dinov2,
    params=_dpt_dinov2_params,
    network=Network("dpt_dinov2", "dpt_dinov2.weights", "dpt-dinov2-large-nyu", ("config.json",)),
)
DEPTH_ANYTHING_V2 = Task(
    "depth",
    "depth-anything-v2",
    version=2,
    run_together=_run_depth_anything,
    params=_depth_anything_params,
    network=Network("depth_anything", "depth_anything_v2.weights", "depth-anything-v2-small", ("config.json",)),
)
DEPTH_ANYTHING_3 = Task(
    "depth",
    "depth-anything-3",
    version=1,
    run_together=_run_depth_anything_3,
    params=_depth_anything_3_params,
    network=Network("depth_anything_3", "depth_anything_3.weights", "depth-anything-3-base", ("config.json",)),
)

STAGE = Stage(
    name="depth",
    about="inverse depth of a frame",
    inputs={"frame": "the frame", "weights": "of the network"},
    arrays={"inverse_depth": layout("float32", "y x", "relative")},
    tasks=(DPT_DINOV2, DEPTH_ANYTHING_V2, DEPTH_ANYTHING_3),
    method=lambda config: config.depth.method,
    choices=(
        Choice(
            "depth",
            "depth.method",
            "--depth",
            (
                Backend("none", "none"),
                Backend("dpt-dinov2", "DINOv2 with DPT", TRANSFORMERS, DPT_DINOV2.network),
                Backend("depth-anything-v2", "Depth Anything V2", TRANSFORMERS, DEPTH_ANYTHING_V2.network),
                Backend("depth-anything-3", "Depth Anything 3", network=DEPTH_ANYTHING_3.network),
                Backend("groundtruth", "exact (synthetic)"),
                Backend("folder", "your own maps"),
            ),
        ),
    ),
)
