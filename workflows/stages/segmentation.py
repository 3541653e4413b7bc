"""Segmentation: labels of a section, 0 if static, else the moving object's identity or its label in given masks."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    identity = inputs["linking"].cached("identity")[params["section"]]
    num_objects = inputs["linking"].attributes["num_objects"]
    moves = np.arange(num_objects) > 0
    if "clustering" in inputs:
        moves = inputs["clustering"].cached("motion") > 0
    names = np.arange(num_objects, dtype=np.uint16)
    if "given" in inputs["linking"].attributes:
        names[1:] = inputs["linking"].attributes["given"]
    label = np.where(moves[identity], names[identity], 0)
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    labels = np.empty(masks.shape, np.uint16)
    # Frame by frame, because NumPy converts labels that index an array to integers of four times their size.
    for mask, out in zip(masks, labels, strict=True):
        out[:] = label[mask]
    return Output({"labels": labels})


def _params(config: PipelineConfig, section: int, num_frames: int) -> dict:
    return {"section": section, "num_frames": num_frames}


MOVING_OBJECTS = Task("segmentation", "moving-objects", version=1, run=_run, params=_params)

STAGE = Stage(
    name="segmentation",
    about="labels of a section's moving objects",
    inputs={
        "proposals": "objects of the section",
        "linking": "identities of its objects",
        "clustering": "motion groups, for a variant that has them",
    },
    arrays={"labels": layout("uint16", "frame y x", "0 static, else the moving object's identity")},
    tasks=(MOVING_OBJECTS,),
)
