"""Objects of a frame: masks of the detections, the best of those that show the same thing."""

from moseg.schemas.parameters import InstanceParams, Sam2Params, SamHqParams
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


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


SAM_HQ = Task("instances", "sam-hq", version=2, run=_run_sam_hq)
SAM2 = Task("instances", "sam2", version=2, run=_run_sam2)
