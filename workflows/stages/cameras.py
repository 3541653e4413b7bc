"""Cameras: the camera's motion over the frame pairs of a window, and depth in its unit, by a network."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import CameraParams, DepthAnything3Params
from moseg.workflows.stages.picture import bars_of, bars_params
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task


def _run_decoder(params, inputs, rng):
    from moseg.tasks.networks.depth_anything_3 import build_depth_anything_3_cameras

    return _estimate(build_depth_anything_3_cameras, params, inputs)


def _run_rays(params, inputs, rng):
    from moseg.tasks.networks.depth_anything_3 import build_depth_anything_3_rays

    return _estimate(build_depth_anything_3_rays, params, inputs)


def _estimate(build, params, inputs):
    from moseg.tasks.cameras import estimate_cameras

    frames = inputs.all("frames")
    picture = bars_of(params).picture(frames[0].shape("image")[:2])
    images = np.stack([frame.cached("image")[picture] for frame in frames])
    camera_params = CameraParams.of_recipe(params["cameras"])
    depth_params = DepthAnything3Params.of_recipe(params["depth_anything_3"])
    with open_network(build, inputs["weights"]) as network:
        found = estimate_cameras(network, images, params["gaps"], camera_params, depth_params)
    return Output(found._asdict(), made_on())


def _params(config: PipelineConfig, bars: BlackBars | None = None) -> dict:
    return {
        **bars_params(bars),
        "cameras": config.cameras.model_dump(mode="json", exclude={"method"}),
        "depth_anything_3": config.depth_anything_3.model_dump(mode="json", exclude={"weights"}),
        "gaps": list(config.rigidity.gaps),
    }


NETWORK = Network("depth_anything_3", "depth_anything_3.weights", "depth-anything-3-base", ("config.json",))
DECODER = Task("cameras", "depth-anything-3", version=1, run=_run_decoder, params=_params, network=NETWORK)
RAYS = Task("cameras", "depth-anything-3-rays", version=1, run=_run_rays, params=_params, network=NETWORK)

STAGE = Stage(
    name="cameras",
    about="the camera's motion over a window's frame pairs, and depth in its unit",
    inputs={"frames": "frames of the window", "weights": "of the network"},
    arrays={
        "pairs": layout("int32", "pair frame_gap", "first frame of the window, and frames to the second"),
        "pose": layout("float64", "pair row column", "[R | t] from the first to the second frame's camera"),
        "intrinsics": layout("float64", "frame row column", "calibration matrix, px of the picture inside black bars"),
        "inverse_depth": layout("float32", "frame y x", "in the inverse of the unit of t; of the picture"),
    },
    tasks=(DECODER, RAYS),
    method=lambda config: None if config.cameras.method == "tracks" else config.cameras.method,
    choices=(
        Choice(
            "cameras",
            "cameras.method",
            "--set cameras.method=",
            (
                Backend("tracks", "fitted to point tracks"),
                Backend(
                    "depth-anything-3", "Depth Anything 3, decoder of cameras", network=NETWORK, cost_suffix="-views"
                ),
                Backend("depth-anything-3-rays", "Depth Anything 3, rays", network=NETWORK, cost_suffix="-rays"),
            ),
        ),
    ),
)
