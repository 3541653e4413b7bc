"""Segmentation: labels of a section, 0 if static, else the moving object's identity or its label in given masks."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.corrected_objects import object_names
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    identity = inputs["linking"].cached("identity")[params["section"]]
    num_objects = inputs["linking"].attributes["num_objects"]
    moves = np.arange(num_objects) > 0
    if "clustering" in inputs:
        moves = inputs["clustering"].cached("motion") > 0
    names = object_names(inputs["linking"].attributes)
    label = np.where(moves[identity], names[identity], 0)
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    labels = np.empty(masks.shape, np.uint16)
    # Frame by frame, because NumPy converts labels that index an array to integers of four times their size.
    for mask, out in zip(masks, labels, strict=True):
        out[:] = label[mask]
    return Output({"labels": labels})


def _run_corrected(params, inputs, rng):
    from moseg.tasks.corrections.relabel import LabelTables, relabel_section

    names = object_names(inputs["linking"].attributes)
    objects = names[inputs["linking"].cached("identity")[params["section"]]]
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    tables = LabelTables(*(inputs["corrected"].cached(name) for name in LabelTables._fields))
    if "painted" not in inputs:
        return Output({"labels": relabel_section(masks, objects, tables, params["start"])})
    painted, erased = inputs["painted"].array("painted"), inputs["painted"].attributes.get("erased", ())
    return Output({"labels": relabel_section(masks, objects, tables, params["start"], painted, erased)})


def _params(config: PipelineConfig, section: int, num_frames: int) -> dict:
    return {"section": section, "num_frames": num_frames}


def _corrected_params(config: PipelineConfig, section: int, num_frames: int, start: int) -> dict:
    return {**_params(config, section, num_frames), "start": start}


MOVING_OBJECTS = Task("segmentation", "moving-objects", version=1, run=_run, params=_params)
CORRECTED = Task("segmentation", "corrected", version=2, run=_run_corrected, params=_corrected_params)

STAGE = Stage(
    name="segmentation",
    about="labels of a section's moving objects",
    inputs={
        "proposals": "objects of the section",
        "linking": "identities of its objects",
        "clustering": "motion groups, for a variant that has them",
        "corrected": "the objects after the user's edits, in place of motion groups",
        "painted": "what the user painted and erased in the section, beside them",
    },
    arrays={"labels": layout("uint16", "frame y x", "0 static, else the moving object's identity")},
    tasks=(MOVING_OBJECTS, CORRECTED),
)
