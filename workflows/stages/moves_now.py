"""Moves now: whether each moving object of a section moves in a frame or rests, and how its flow makes it grow."""

from collections.abc import Sequence

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
    from moseg.tasks.saliency import flow_growth, moves_now

    read = MovesNowParams.of_recipe(params["moves_now"])
    labels, num_objects = inputs["segmentation"].array("labels"), count_objects(inputs)
    shares = params.get("previous", [1.0] * len(labels))
    moves, growth = [], []
    frames = zip(inputs.all("saliency"), labels, shares, strict=True)
    for t, (frame, objects, share) in enumerate(frames, params["start"]):
        # The flow of a missing neighbour is stored as zeros.
        is_given = (t > 0, t + 1 < params["num_frames"])
        flows, residuals = (
            [field if given else None for field, given in zip(to_float32(frame.array(name)), is_given, strict=True)]
            for name in ("flows", "residual_flows")
        )
        height, width = frame.shape("saliency")
        reduced = cv2.resize(objects, (width, height), interpolation=cv2.INTER_NEAREST)
        moves.append(moves_now(reduced, flows, residuals, num_objects, read))
        growth.append(share * flow_growth(reduced, flows[0], num_objects))
    return Output({"moves": np.stack(moves), "growth": np.stack(growth)})


def _params(config: PipelineConfig, start: int, num_frames: int, previous: Sequence[float] = ()) -> dict:
    """Return the parameters of a section whose neighbours are told by `start`, 0 or 1, and `num_frames` with them.

    `previous` is the share of the motion to the compared picture that lies between each frame and the one before; empty
    where it is all of it.
    """
    params = {"start": start, "num_frames": num_frames, "moves_now": config.moves_now.model_dump(mode="json")}
    return {**params, "previous": [*previous]} if previous else params


BEYOND_NOISE = Task("moves_now", "beyond-noise", version=3, run=_run, params=_params)

STAGE = Stage(
    name="moves_now",
    about="whether each object moves in a section's frames or rests, and how its flow makes it grow",
    inputs={
        "segmentation": "labels of the section's moving objects",
        "linking": "identities of the objects of all sections",
        "corrected": "the objects after the user's edits, in place of them",
        "saliency": "saliency of the section's frames",
    },
    arrays={
        "moves": layout("int8", "frame object", "1 moves, 0 rests, -1 unseen"),
        "growth": layout(
            "float64", "frame object", "logarithm of its area over that in the frame before, by its flow; NaN: unknown"
        ),
    },
    tasks=(BEYOND_NOISE,),
)
