"""Confidence: expected precision and recall of the mask of each moving object of a section."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ConfidenceParams
from moseg.workflows.stages.corrected_objects import count_objects
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    import cv2

    from moseg.tasks.confidence import estimate_confidence, mask_evidence
    from moseg.tasks.half_floats import to_float32

    read = ConfidenceParams.of_recipe(params["confidence"])
    labels, num_objects = inputs["segmentation"].array("labels"), count_objects(inputs)
    found = []
    for objects, foreground in zip(labels, inputs["foreground"].array("foreground"), strict=True):
        height, width = foreground.shape
        reduced = cv2.resize(objects, (width, height), interpolation=cv2.INTER_NEAREST)
        evidence = mask_evidence(reduced, to_float32(foreground), num_objects, read)
        found.append(estimate_confidence(evidence, read))
    return Output({name: np.stack([getattr(each, name) for each in found]) for name in ("sure", "complete")})


def _params(config: PipelineConfig) -> dict:
    return {"confidence": config.confidence.model_dump(mode="json")}


CALIBRATED = Task("confidence", "calibrated", version=3, run=_run, params=_params)

STAGE = Stage(
    name="confidence",
    about="how sure and how complete a section's moving objects are",
    inputs={
        "segmentation": "labels of the section's moving objects",
        "linking": "identities of the objects of all sections",
        "corrected": "the objects after the user's edits, in place of them",
        "foreground": "probability to move of each pixel of the section",
    },
    arrays={
        "sure": layout("float64", "frame object", "expected precision of the mask, 0..1; NaN where unseen"),
        "complete": layout("float64", "frame object", "expected recall of the mask, 0..1; NaN where unseen"),
    },
    tasks=(CALIBRATED,),
)
