"""Weights that the networks of a configuration read."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.stages.registry import STAGES, all_choices
from moseg.workflows.stages.task import Network


def needed_items(config: PipelineConfig) -> dict[str, str]:
    """Return the weights items that a configuration reads, by name, each with the architecture that it must have.

    Raises
    ------
    InputError
        One item is chosen for two networks.
    """
    items: dict[str, str] = {}
    for network in networks(config):
        item = network.item(config)
        architecture = items.setdefault(item, network.architecture)
        if architecture != network.architecture:
            got, expected = f"{architecture} and {network.architecture}", "an item for each"
            raise InputError("weights named for two networks", where=item, got=got, expected=expected)
    return items


def networks(config: PipelineConfig) -> list[Network]:
    """Return the networks that a configuration runs, in the order of the stages."""
    chosen = ((stage, stage.chosen(config)) for stage in STAGES.values())
    tasks = (task for stage, method in chosen for task in stage.tasks if task.method == method)
    return [task.network for task in tasks if task.network is not None]


def parameters_of(architecture: str) -> tuple[str, ...]:
    """Return the parameters that can name a weights item of an architecture, for ``--set``."""
    backends = (backend for choice in all_choices() for backend in choice.backends if backend.network is not None)
    found = (each.network.parameter for each in backends if each.network.architecture == architecture)
    return tuple(dict.fromkeys(found))
