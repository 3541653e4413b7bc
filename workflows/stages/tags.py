"""Names of what a frame shows."""

from moseg.schemas.parameters import RamParams
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


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


RAM = Task("tags", "ram", version=2, run=_run_ram)
RAM_PLUS = Task("tags", "ram-plus", version=2, run=_run_ram_plus)
