"""Detections: boxes of the named objects in a frame."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import GroundingDinoParams
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import TRANSFORMERS, Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task

DOCUMENTS = ("config.json", "preprocessor_config.json", "vocab.txt")


def _run(params, inputs, rng):
    from moseg.tasks.detections import detect_objects
    from moseg.tasks.networks.grounding_dino import build_grounding_dino

    names = inputs["tags"].attributes["names"] if "tags" in inputs else params["tags"]
    with open_network(build_grounding_dino, inputs["weights"]) as detector:
        found = detect_objects(
            detector, inputs["frame"].cached("image"), names, GroundingDinoParams.of_recipe(params["grounding_dino"])
        )
    return Output({"boxes": found.boxes, "scores": found.scores}, {"tags": list(found.tags), **made_on()})


def _params(config: PipelineConfig) -> dict:
    params = {"grounding_dino": config.grounding_dino.model_dump(mode="json", exclude={"weights"})}
    if config.detections.tags is not None:
        params["tags"] = list(config.detections.tags)
    return params


GROUNDING_DINO = Task(
    "detections",
    "grounding-dino",
    version=2,
    run=_run,
    params=_params,
    network=Network("grounding_dino", "grounding_dino.weights", "grounding-dino-tiny", DOCUMENTS),
)

STAGE = Stage(
    name="detections",
    about="boxes of the named objects in a frame",
    inputs={"frame": "the frame", "tags": "names to look for, unless the user gives them", "weights": "of the network"},
    arrays={"boxes": layout("float32", "detection xyxy", "px"), "scores": layout("float64", "detection", "0..1")},
    tasks=(GROUNDING_DINO,),
    method=lambda config: "grounding-dino" if config.proposal_source == "detections" else None,
    choices=(
        Choice(
            "detector",
            "",
            "--proposals",
            (
                Backend(
                    "grounding-dino",
                    "Grounding DINO",
                    TRANSFORMERS,
                    GROUNDING_DINO.network,
                    option="--proposals detections",
                ),
            ),
            is_once_a_section=True,
        ),
    ),
)
