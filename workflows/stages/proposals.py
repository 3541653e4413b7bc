"""Object proposals of a section: space-time components of motion saliency, or masks that were given."""

import numpy as np

from moseg_tasks.proposals.boxes import object_boxes
from moseg_tasks.proposals.components import propose_objects
from moseg_tasks.proposals.given import relabel_masks
from moseg_tasks.saliency import accumulate_saliency
from schemas.parameters import ProposalParams
from workflows.resize import resize_labels
from workflows.stages.task import Output, Task


def _run_saliency(params, inputs, rng):
    proposal_params = ProposalParams(**params["proposals"])
    frames = inputs.all("saliency")
    saliency = np.stack([frame.array("saliency") for frame in frames])
    flows = np.stack([frame.array("flows") for frame in frames])
    accumulated = accumulate_saliency(saliency, flows, proposal_params)
    first, last = params["first"], params["last"]
    result = propose_objects(accumulated[first:last], tuple(params["shape"]), proposal_params)
    return Output({"masks": result.masks, "scores": result.scores, "boxes": result.boxes})


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


SALIENCY_COMPONENTS = Task("proposals", "saliency", version=1, run=_run_saliency)
GIVEN_MASKS = Task("proposals", "given", version=1, run=_run_given)
