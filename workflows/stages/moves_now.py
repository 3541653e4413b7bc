"""Moves now: whether each moving object of a section moves in a frame, or rests."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import MovesNowParams
from moseg.workflows.stages.corrected_objects import count_objects
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    import cv2

    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.saliency import moves_now

    read = MovesNowParams.of_recipe(params["moves_now"])
    labels, num_objects = inputs["segmentation"].array("labels"), count_objects(inputs)
    moves = []
    for t, (frame, objects) in enumerate(zip(inputs.all("saliency"), labels, strict=True), params["start"]):
        # The flow of a missing neighbour is stored as zeros.
        is_given = (t > 0, t + 1 < params["num_frames"])
        flows, residuals = (
            [field if given else None for field, given in zip(to_float32(frame.array(name)), is_given, strict=True)]
            for name in ("flows", "residual_flows")
        )
        height, width = frame.shape("saliency")
        reduced = cv2.resize(objects, (width, height), interpolation=cv2.INTER_NEAREST)
        moves.append(moves_now(reduced, flows, residuals, num_objects, read))
    return Output({"moves": np.stack(moves)})


def _params(config: PipelineConfig, start: int, num_frames: int) -> dict:
    """Return the parameters of a section whose neighbours are told by `start`, 0 or 1, and `num_frames` with them."""
    return {"start": start, "num_frames": num_frames, "moves_now": config.moves_now.model_dump(mode="json")}


BEYOND_NOISE = Task("moves_now", "beyond-noise", version=1, run=_run, params=_params)

STAGE = Stage(
    name="moves_now",
    about="whether each object moves in a section's frames or rests",
    inputs={
        "segmentation": "labels of the section's moving objects",
        "linking": "identities of the objects of all sections",
        "corrected": "the objects after the user's edits, in place of them",
        "saliency": "saliency of the section's frames",
    },
    arrays={"moves": layout("int8", "frame object", "1 moves, 0 rests, -1 unseen")},
    tasks=(BEYOND_NOISE,),
)
