"""Instances: objects of a frame, the best mask of each that detections, moving regions or their names show."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import (
    EdgeTamParams,
    InstanceParams,
    MotionPromptParams,
    Sam2Params,
    Sam3Params,
    SamHqParams,
)
from moseg.workflows.stages.motion_prompts import choice_params
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import TRANSFORMERS, Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task


def _run_sam_hq(params, inputs, rng):
    from moseg.tasks.instances.sam_hq import segment_boxes_sam_hq
    from moseg.tasks.networks.sam_hq import build_sam_hq

    return _outline(build_sam_hq, segment_boxes_sam_hq, SamHqParams.of_recipe(params["sam_hq"]), params, inputs)


def _run_sam2(params, inputs, rng):
    from moseg.tasks.instances.sam2 import segment_boxes_sam2
    from moseg.tasks.networks.sam2 import build_sam2_image

    return _outline(build_sam2_image, segment_boxes_sam2, Sam2Params.of_recipe(params["sam2"]), params, inputs)


def _run_edgetam(params, inputs, rng):
    from moseg.tasks.instances.sam2 import segment_boxes_sam2
    from moseg.tasks.networks.edgetam import build_edgetam_image

    network_params = EdgeTamParams.of_recipe(params["edgetam"])
    return _outline(build_edgetam_image, segment_boxes_sam2, network_params, params, inputs)


def _run_sam2_prompts(params, inputs, rng):
    from moseg.tasks.networks.sam2 import build_sam2_image

    return _outline_prompted(build_sam2_image, Sam2Params.of_recipe(params["sam2"]), params, inputs)


def _run_edgetam_prompts(params, inputs, rng):
    from moseg.tasks.networks.edgetam import build_edgetam_image

    return _outline_prompted(build_edgetam_image, EdgeTamParams.of_recipe(params["edgetam"]), params, inputs)


def _run_sam3(params, inputs, rng):
    from moseg.tasks.instances.sam3 import segment_concepts
    from moseg.tasks.networks.sam3 import build_sam3_detector

    network_params = Sam3Params.of_recipe(params["sam3"])
    with open_network(build_sam3_detector, inputs["weights"]) as detector:
        image = inputs["frame"].cached("image")
        found = segment_concepts(detector, image, network_params.concepts, network_params)
    return _select(found.masks, found.scores, found.tags, params)


def _outline_prompted(build, network_params, params, inputs):
    from moseg.tasks.instances.motion_prompts import MotionPrompts, choose_masks
    from moseg.tasks.instances.sam2 import segment_prompts_sam2

    read, found = MotionPromptParams.of_recipe(params["motion_prompts"]), inputs["prompts"]
    labels, boxes, points = (found.array(name) for name in ("labels", "boxes", "points"))
    prompts = MotionPrompts(labels, boxes, points, np.array(found.attributes["regions"], np.intp))
    with open_network(build, inputs["weights"]) as network:
        masks, quality = segment_prompts_sam2(
            network,
            inputs["frame"].cached("image"),
            None if read.use == "points" else boxes,
            None if read.use == "box" else points,
            network_params,
        )
    region, chosen = choose_masks(masks, quality, prompts, read)
    return _select(masks[region, chosen], quality[region, chosen], [""] * len(region), params)


def _outline(build, segment_boxes, network_params, params, inputs):
    boxes, scores = (inputs["detections"].array(name) for name in ("boxes", "scores"))
    tags = inputs["detections"].attributes["tags"]
    with open_network(build, inputs["weights"]) as network:
        masks, _ = segment_boxes(network, inputs["frame"].cached("image"), boxes, network_params)
    return _select(masks, scores, tags, params)


def _select(masks, scores, tags, params):
    """Return the output of the masks that are objects of their own."""
    from moseg.tasks.instances import paint_instances, select_instances

    instance_params = InstanceParams.of_recipe(params["instances"])
    kept = select_instances(masks, scores, instance_params)
    painted = paint_instances(masks[kept], scores[kept], instance_params.min_area)
    chosen = kept[painted.order]
    return Output(
        {"labels": painted.labels, "scores": scores[chosen]}, {"tags": [tags[index] for index in chosen], **made_on()}
    )


def _sam_hq_params(config: PipelineConfig) -> dict:
    network = config.sam_hq.model_dump(mode="json", exclude={"weights"})
    return {"sam_hq": network, "instances": config.instances.model_dump(mode="json")}


TRACKER_PARAMS = frozenset({"weights", "objects_per_pass", "memory_reach"})
"""Parameters of SAM 2.1 and EdgeTAM that masks of one frame do not read."""
SAM3_DOCUMENTS = ("config.json", "vocab.json", "merges.txt")


def _sam2_params(config: PipelineConfig) -> dict:
    network = config.sam2.model_dump(mode="json", exclude=TRACKER_PARAMS)
    return {"sam2": network, "instances": config.instances.model_dump(mode="json")}


def _edgetam_params(config: PipelineConfig) -> dict:
    network = config.edgetam.model_dump(mode="json", exclude=TRACKER_PARAMS)
    return {"edgetam": network, "instances": config.instances.model_dump(mode="json")}


def _sam3_params(config: PipelineConfig) -> dict:
    network = config.sam3.model_dump(mode="json", exclude={"weights", "memory_reach"})
    network["concepts"] = list(config.named_objects)
    return {"sam3": network, "instances": config.instances.model_dump(mode="json")}


def _sam2_prompts_params(config: PipelineConfig) -> dict:
    return {**_sam2_params(config), "motion_prompts": choice_params(config)}


def _edgetam_prompts_params(config: PipelineConfig) -> dict:
    return {**_edgetam_params(config), "motion_prompts": choice_params(config)}


def _method(config: PipelineConfig) -> str | None:
    if config.proposal_source == "motion-prompts":
        return f"{config.detections.masks}-prompts"
    if config.proposal_source == "sam3":
        return "sam3"
    return config.detections.masks if config.proposal_source == "detections" else None


SAM_HQ = Task(
    "instances",
    "sam-hq",
    version=2,
    run=_run_sam_hq,
    params=_sam_hq_params,
    network=Network("sam_hq", "sam_hq.weights", "sam-hq-vit-large", ("config.json",)),
)
SAM2 = Task(
    "instances",
    "sam2",
    version=2,
    run=_run_sam2,
    params=_sam2_params,
    network=Network("sam2", "sam2.weights", "sam2.1-hiera-large", ("config.json",)),
)
SAM2_PROMPTS = Task(
    "instances",
    "sam2-prompts",
    version=1,
    run=_run_sam2_prompts,
    params=_sam2_prompts_params,
    network=SAM2.network,
)
EDGETAM = Task(
    "instances",
    "edgetam",
    version=1,
    run=_run_edgetam,
    params=_edgetam_params,
    network=Network("edgetam", "edgetam.weights", "edgetam", ("config.json",)),
)
EDGETAM_PROMPTS = Task(
    "instances",
    "edgetam-prompts",
    version=1,
    run=_run_edgetam_prompts,
    params=_edgetam_prompts_params,
    network=EDGETAM.network,
)
SAM3 = Task(
    "instances",
    "sam3",
    version=1,
    run=_run_sam3,
    params=_sam3_params,
    network=Network("sam3", "sam3.weights", "sam3", SAM3_DOCUMENTS),
)

STAGE = Stage(
    name="instances",
    about="objects that the networks find in a frame",
    inputs={
        "frame": "the frame",
        "detections": "boxes of its objects (not of SAM 3, which finds them itself)",
        "prompts": "points and boxes of its moving regions, in place of the detections",
        "weights": "of the network",
    },
    arrays={
        "labels": layout("uint16", "y x", "object of the frame, 0 = background"),
        "scores": layout("float64", "object"),
    },
    tasks=(SAM_HQ, SAM2, SAM2_PROMPTS, EDGETAM, EDGETAM_PROMPTS, SAM3),
    method=_method,
    choices=(
        Choice(
            "masks",
            "detections.masks",
            "--masks",
            (
                Backend("sam-hq", "SAM-HQ", TRANSFORMERS, SAM_HQ.network),
                Backend("sam2", "SAM 2.1", TRANSFORMERS, SAM2.network),
                Backend("edgetam", "EdgeTAM", TRANSFORMERS, EDGETAM.network),
            ),
            is_once_a_section=True,
        ),
        Choice(
            "objects by name",
            "",
            "--proposals",
            (Backend("sam3", "SAM 3", TRANSFORMERS, SAM3.network, option="--proposals sam3"),),
            is_once_a_section=True,
        ),
    ),
)
