"""Corrected objects: the objects of a result that the user corrects, and the label of each pixel's object."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Edit
from moseg.workflows.stages.inputs import ArtifactView, Inputs
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def count_objects(inputs: Inputs) -> int:
    """Return the number of identities, the background's included, of a recipe's corrected or linked objects."""
    role = "corrected" if "corrected" in inputs else "linking"
    return inputs[role].attributes["num_objects"]


def object_names(attributes: dict) -> np.ndarray:
    """Return the identity of each object of a linking in labels, uint16 (object,): its number, or its given label."""
    names = np.arange(attributes["num_objects"], dtype=np.uint16)
    if "given" in attributes:
        names[1:] = attributes["given"]
    return names


def small_of(linking: ArtifactView, areas: Sequence[ArtifactView], min_area: float) -> frozenset[int]:
    """Return the objects of a linking, as they are called in the labels, that are too small for the result."""
    from moseg.tasks.corrections.areas import small_objects

    names = object_names(linking.attributes)
    objects = [names[section] for section in linking.cached("identity")]
    return small_objects(zip(objects, [each.cached("areas") for each in areas], strict=True), min_area)


def _run(params, inputs, rng):
    from moseg.tasks.corrections.relabel import label_tables, motion_array
    from moseg.tasks.corrections.replay import replay_steps
    from moseg.tasks.corrections.steps import read_steps

    names = object_names(inputs["linking"].attributes)
    # Without motion groups each object moves.
    motion = inputs["clustering"].cached("motion") if "clustering" in inputs else np.arange(len(names))
    motions = dict(zip(names[1:].tolist(), motion[1:].tolist(), strict=True))
    small = small_of(inputs["linking"], inputs.all("areas"), params["min_area"]) if "areas" in inputs else ()
    corrected = replay_steps(read_steps(params["steps"]), motions, params["num_frames"], small=small)
    arrays = {**label_tables(corrected)._asdict(), "motion": motion_array(corrected)}
    found = {"identities": list(corrected.motions), "shown": sorted(corrected.shown)}
    return Output(arrays, {"num_objects": len(arrays["motion"]), **found})


def _params(config: PipelineConfig, edits: tuple[Edit, ...], num_frames: int) -> dict:
    # Here, because programs start without the tasks.
    from moseg.tasks.corrections.steps import recipe_steps

    min_area = {"min_area": config.moving_objects.min_area} if config.moving_objects.min_area else {}
    return {"steps": recipe_steps(edits), "num_frames": num_frames, **min_area}


EDITS = Task("corrected_objects", "edits", version=2, run=_run, params=_params)

STAGE = Stage(
    name="corrected_objects",
    about="objects of a sequence after the user's edits, without small ones",
    inputs={
        "linking": "identities of the objects of all sections",
        "clustering": "motion groups, for a variant that has them",
        "areas": "how large the objects of every section become, if small ones are left out",
    },
    arrays={
        "labels": layout("int32", "run column", "object, first frame, label from there on; 0 = not in the result"),
        "stroke_labels": layout("int32", "run column", "the same of each number of strokes"),
        "members": layout(
            "int32", "run column", "number of strokes that erase, object that they erase, first frame, stop"
        ),
        "stroke_members": layout("int32", "run column", "the same of numbers of strokes that they erase"),
        "motion": layout("uint16", "object", "motion group, 0 = the background's"),
    },
    tasks=(EDITS,),
)
