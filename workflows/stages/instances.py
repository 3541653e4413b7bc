"""Instances: objects of a frame, the best mask of each that the detections show."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import InstanceParams, Sam2Params, SamHqParams
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


def _outline(build, segment_boxes, network_params, params, inputs):
    from moseg.tasks.instances import paint_instances, select_instances

    boxes, scores = (inputs["detections"].array(name) for name in ("boxes", "scores"))
    tags = inputs["detections"].attributes["tags"]
    with open_network(build, inputs["weights"]) as network:
        masks, _ = segment_boxes(network, inputs["frame"].cached("image"), boxes, network_params)
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


def _sam2_params(config: PipelineConfig) -> dict:
    # The other parameters are those of the tracker.
    network = config.sam2.model_dump(mode="json", exclude={"weights", "objects_per_pass", "memory_reach"})
    return {"sam2": network, "instances": config.instances.model_dump(mode="json")}


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

STAGE = Stage(
    name="instances",
    about="objects that the networks find in a frame",
    inputs={"frame": "the frame", "detections": "boxes of its objects", "weights": "of the network"},
    arrays={
        "labels": layout("uint16", "y x", "object of the frame, 0 = background"),
        "scores": layout("float64", "object"),
    },
    tasks=(SAM_HQ, SAM2),
    method=lambda config: config.detections.masks if config.proposal_source == "detections" else None,
    choices=(
        Choice(
            "masks",
            "detections.masks",
            "--masks",
            (
                Backend("sam-hq", "SAM-HQ", TRANSFORMERS, SAM_HQ.network),
                Backend("sam2", "SAM 2.1", TRANSFORMERS, SAM2.network),
            ),
            is_once_a_section=True,
        ),
    ),
)
