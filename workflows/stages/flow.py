"""Flow: dense optical flow from one frame to a neighbour."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import FlowParams, RaftParams, SeaRaftParams
from moseg.workflows.stages.image_sizes import run_by_image_size
from moseg.workflows.stages.inputs import ArtifactView
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import OPENCV, Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task


def _run_dis(params, inputs, rng):
    from moseg.tasks.flow.dis import search_flow
    from moseg.tasks.flow.flow_grid import SIZE

    image0, image1 = (inputs[role].cached("image") for role in ("frame0", "frame1"))
    flow, size = search_flow(image0, image1, FlowParams.of_recipe(params)), image0.shape[:2]
    return Output({"flow": flow}, {} if flow.shape[:2] == size else {SIZE: list(size)})


def read_flow(view: ArtifactView) -> np.ndarray:
    """Return the flow of a view's artifact at its frames' size, float32 (y, x, 2), px/frame."""
    from moseg.tasks.flow.flow_grid import full_flow

    return full_flow(view.cached("flow"), view.attributes)


def frame_shape(view: ArtifactView) -> tuple[int, int]:
    """Return the height and width of the frames of a view's artifact, px."""
    from moseg.tasks.flow.flow_grid import SIZE

    height, width = view.attributes.get(SIZE, view.shape("flow")[:2])
    return height, width


def flow_on_working_grid(view: ArtifactView, side: int) -> np.ndarray:
    """Return the flow of a view's artifact on the grid of `side` px, float32 (y, x, 2), px of that grid.

    Given flow has gaps where its files hold no value, but every pixel of a map needs flow.
    """
    from moseg.tasks.flow.fill_unknown import fill_unknown
    from moseg.tasks.frame_grid import flow_on_grid, grid_shape

    shape = frame_shape(view)
    return flow_on_grid(fill_unknown(view.cached("flow")), grid_shape(shape, side), shape)


def _dis_params(config: PipelineConfig) -> dict:
    return config.flow.model_dump(mode="json", exclude={"method"})


def _run_raft(params, inputs):
    from moseg.tasks.networks.raft import build_raft

    return _estimate(build_raft, RaftParams.of_recipe(params["raft"]), inputs)


def _raft_params(config: PipelineConfig) -> dict:
    return {"raft": config.raft.model_dump(mode="json", exclude={"weights"})}


def _run_sea_raft(params, inputs):
    from moseg.tasks.networks.sea_raft import build_sea_raft

    return _estimate(build_sea_raft, SeaRaftParams.of_recipe(params["sea_raft"]), inputs)


def _sea_raft_params(config: PipelineConfig) -> dict:
    return {"sea_raft": config.sea_raft.model_dump(mode="json", exclude={"weights"})}


def _estimate(build, params, inputs):
    from moseg.tasks.flow.raft import estimate_raft_flow

    with open_network(build, inputs[0]["weights"]) as network:
        flows = run_by_image_size(
            lambda images: estimate_raft_flow(network, *images, params), inputs, ("frame0", "frame1")
        )
    return [Output({"flow": flow}, made_on()) for flow in flows]


DIS = Task("flow", "dis", version=6, run=_run_dis, params=_dis_params, is_cheap=True, is_cue=True)
RAFT = Task(
    "flow",
    "raft",
    version=2,
    run_together=_run_raft,
    params=_raft_params,
    network=Network("raft", "raft.weights", "raft-large"),
)
SEA_RAFT = Task(
    "flow",
    "sea-raft",
    version=1,
    run_together=_run_sea_raft,
    params=_sea_raft_params,
    network=Network("sea_raft", "sea_raft.weights", "sea-raft-m"),
)

STAGE = Stage(
    name="flow",
    about="optical flow of a frame pair",
    inputs={"frame0": "frame that the flow starts in", "frame1": "its neighbour", "weights": "of the network"},
    arrays={"flow": layout("float32", "y x uv", "px/frame; of the frames' size, or on a coarser grid", step=1 / 32)},
    tasks=(DIS, RAFT, SEA_RAFT),
    method=lambda config: config.flow.method,
    choices=(
        Choice(
            "flow",
            "flow.method",
            "--flow",
            (
                Backend("dis", "DIS, both directions", OPENCV),
                Backend("raft", "RAFT", network=RAFT.network),
                Backend("sea-raft", "SEA-RAFT", network=SEA_RAFT.network),
                Backend("groundtruth", "exact (synthetic)"),
                Backend("folder", "your own flow"),
            ),
        ),
    ),
)
