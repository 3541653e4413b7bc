"""Object proposals of a section: outlines of what moves, masks tracked from the first frame, or given ones."""

import numpy as np

from moseg.schemas.parameters import DeaotParams, RefinementParams, Sam2Params
from moseg.tasks.half_floats import to_float32
from moseg.tasks.proposals.boxes import object_boxes
from moseg.tasks.proposals.given import relabel_masks
from moseg.tasks.proposals.refinement import refine_outlines
from moseg.workflows.sources.resize import resize_labels
from moseg.workflows.stages.components import join_rows
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


def _run_saliency(params, inputs, rng):
    refinement = RefinementParams.of_recipe(params["refinement"])
    components, frames = inputs["components"], inputs.all("frames")
    labels, scores = components.array("labels"), components.array("scores")
    foreground = join_rows(inputs.all("foreground"), "foreground", len(labels))
    masks = np.stack(
        [
            refine_outlines(frame.cached("image"), objects, to_float32(probability), refinement)
            for frame, objects, probability in zip(frames, labels, foreground, strict=True)
        ]
    )
    return Output({"masks": masks, "scores": scores, "boxes": object_boxes(masks, len(scores))})


def _run_given(params, inputs, rng):
    # A frame without a given mask shows no object.
    given = np.zeros((params["stop"] - params["start"], *params["shape"]), np.uint16)
    for row, frame in enumerate(inputs["masks"].attributes["indices"]):
        if params["start"] <= frame < params["stop"]:
            mask = inputs["masks"].rows("masks", row, row + 1)[0]
            given[frame - params["start"]] = resize_labels(mask, tuple(params["shape"]))
    if params["void"] is not None:
        given[given == params["void"]] = 0
    masks, identities = relabel_masks(given)
    boxes = object_boxes(masks, len(identities))
    return Output(
        {"masks": masks, "scores": np.ones(len(identities)), "boxes": boxes},
        {"identities": identities.tolist()},
    )


def _run_deaot(params, inputs, rng):
    from moseg.tasks.networks.deaot import build_deaot
    from moseg.tasks.proposals.deaot import track_masks_deaot

    return _track(build_deaot, track_masks_deaot, DeaotParams.of_recipe(params["deaot"]), inputs)


def _run_sam2(params, inputs, rng):
    from moseg.tasks.networks.sam2 import build_sam2_video
    from moseg.tasks.proposals.sam2 import track_masks_sam2

    return _track(build_sam2_video, track_masks_sam2, Sam2Params.of_recipe(params["sam2"]), inputs)


def _track(build, track_masks, tracker_params, inputs):
    seeds = inputs["seeds"]
    frames = (frame.cached("image") for frame in inputs.all("frames"))
    identities = seeds.array("identities")
    with open_network(build, inputs["weights"]) as network:
        masks = track_masks(network, frames, seeds.array("labels"), tracker_params)
    return Output(
        {"masks": masks, "scores": seeds.array("scores"), "boxes": object_boxes(masks, len(identities))},
        {
            "identities": identities.tolist(),
            "tags": seeds.attributes["tags"],
            "num_identities": seeds.attributes["num_identities"],
            **made_on(),
        },
    )


SALIENCY = Task("proposals", "saliency", version=2, run=_run_saliency)
GIVEN_MASKS = Task("proposals", "given", version=1, run=_run_given)
DEAOT = Task("proposals", "deaot", version=1, run=_run_deaot)
SAM2 = Task("proposals", "sam2", version=2, run=_run_sam2)
