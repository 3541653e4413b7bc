"""Tags: names of what a frame shows."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import RamParams
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task

DOCUMENTS = ("tags.txt", "thresholds.txt")


def _run_ram(params, inputs, rng):
    from moseg.tasks.networks.ram import build_ram

    return _recognise(build_ram, params, inputs)


def _run_ram_plus(params, inputs, rng):
    from moseg.tasks.networks.ram import build_ram_plus

    return _recognise(build_ram_plus, params, inputs)


def _recognise(build, params, inputs):
    from moseg.tasks.tags import recognise_tags

    with open_network(build, inputs["weights"]) as tagger:
        tags = recognise_tags(tagger, inputs["frame"].cached("image"), RamParams.of_recipe(params["ram"]))
    return Output({}, {"names": list(tags.names), "scores": tags.scores.tolist(), **made_on()})


def _ram_params(config: PipelineConfig) -> dict:
    return {"ram": config.ram.model_dump(mode="json", exclude={"weights"})}


def _tagger(config: PipelineConfig) -> str | None:
    """Return the tagger; with names given by the user, nothing is tagged."""
    uses_tags = config.proposal_source == "detections" and config.detections.tags is None
    return config.detections.tagger if uses_tags else None


RAM = Task(
    "tags", "ram", version=2, run=_run_ram, params=_ram_params, network=Network("ram", "ram.weights", "ram", DOCUMENTS)
)
RAM_PLUS = Task(
    "tags",
    "ram-plus",
    version=2,
    run=_run_ram_plus,
    params=_ram_params,
    network=Network("ram_plus", "ram.weights", "ram-plus", DOCUMENTS),
)

STAGE = Stage(
    name="tags",
    about="names of what a frame shows",
    inputs={"frame": "the frame", "weights": "of the network"},
    arrays={},
    tasks=(RAM, RAM_PLUS),
    method=_tagger,
    choices=(
        Choice(
            "tagger",
            "detections.tagger",
            "--tagger",
            (
                Backend("ram", "RAM", network=RAM.network),
                Backend("ram-plus", "RAM++", network=RAM_PLUS.network),
                Backend("given", "your own tags", option="--tags car,person"),
            ),
            is_once_a_section=True,
        ),
    ),
)
