"""Grown object: mask of the object at points of a frame, from motion and colour or by SAM 2.1."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Growing
from moseg.schemas.parameters import AppearanceParams, GrowingParams, RefinementParams
from moseg.workflows.stages.carried_mask import COLOUR_PARAMS
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Network, Output, Task


def _run_region(params, inputs, rng):
    from moseg.tasks.corrections.growing import Grower, grow_object
    from moseg.tasks.half_floats import to_float32

    image, saliency = inputs["frame"].cached("image"), inputs["saliency"]
    grower = Grower(
        GrowingParams.of_recipe(params["growing"]),
        AppearanceParams.of_recipe(params["appearance"]),
        RefinementParams.of_recipe(params["refinement"]),
    )
    evidence = (to_float32(saliency.array(name)) for name in ("saliency", "residual_flows"))
    return Output({"mask": grow_object(image, *evidence, *_points(params, image), grower)})


def _run_sam2(params, inputs, rng):
    from moseg.tasks.corrections.sam2_points import segment_points_sam2
    from moseg.tasks.networks.sam2 import build_sam2_image

    image = inputs["frame"].cached("image")
    with open_network(build_sam2_image, inputs["weights"]) as network:
        mask = segment_points_sam2(network, image, *_points(params, image))
    return Output({"mask": mask}, made_on())


def _points(params, image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    from moseg.tasks.corrections.strokes import analysed_points

    size = tuple(params["frame_size"])
    return tuple(analysed_points(params[name], image.shape[:2], size) for name in ("points", "not_points"))


def _at(growing: Growing, frame_size: tuple[int, int]) -> dict:
    points = growing.model_dump(mode="json", include={"points", "not_points"})
    return {**points, "frame_size": list(frame_size)}


def _region_params(config: PipelineConfig, growing: Growing, frame_size: tuple[int, int]) -> dict:
    return {
        **_at(growing, frame_size),
        "growing": config.growing.model_dump(mode="json"),
        "appearance": config.appearance.model_dump(mode="json", include=COLOUR_PARAMS),
        "refinement": config.refinement.model_dump(mode="json"),
    }


def _sam2_params(config: PipelineConfig, growing: Growing, frame_size: tuple[int, int]) -> dict:
    return _at(growing, frame_size)


REGION = Task("grown_object", "region", version=3, run=_run_region, params=_region_params)
SAM2 = Task(
    "grown_object",
    "sam2",
    version=1,
    run=_run_sam2,
    params=_sam2_params,
    network=Network("sam2", "sam2.weights", "sam2.1-hiera-large", ("config.json",)),
)

STAGE = Stage(
    name="grown_object",
    about="object at points that a user chose in a frame",
    inputs={"frame": "the frame", "saliency": "its motion saliency (region)", "weights": "of the network (sam2)"},
    arrays={"mask": layout("bool", "y x")},
    tasks=(REGION, SAM2),
    # The edit chooses, not the configuration.
    method=lambda config: None,
)
