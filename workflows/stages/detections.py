"""Boxes of the named objects in a frame."""

from moseg.schemas.parameters import GroundingDinoParams
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.detections import detect_objects
    from moseg.tasks.networks.grounding_dino import build_grounding_dino

    names = inputs["tags"].attributes["names"] if "tags" in inputs else params["tags"]
    with open_network(build_grounding_dino, inputs["weights"]) as detector:
        found = detect_objects(
            detector, inputs["frame"].cached("image"), names, GroundingDinoParams.of_recipe(params["grounding_dino"])
        )
    return Output({"boxes": found.boxes, "scores": found.scores}, {"tags": list(found.tags), **made_on()})


GROUNDING_DINO = Task("detections", "grounding-dino", version=2, run=_run)
