"""Merits of each choice of a method: public figures, cost and licence."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from moseg.schemas.configs import MOVING_SOURCES, PipelineConfig
from moseg.schemas.weights import WeightsItem
from moseg.workflows.stages.registry import STAGES, all_choices
from moseg.workflows.stages.stage import Backend, Choice
from moseg.workflows.weights.costs import LIGHT, read_costs
from moseg.workflows.weights.figures import FIGURES, Figure

GIVEN = ("groundtruth", "folder", "given", "none")
"""Methods that compute nothing."""


class Merit(NamedTuple):
    """One choice: a method, with weights where it is a network.

    Attributes
    ----------
    choice : str
    option : str
        Option that chooses the method.
    weights : str
        Weights item; empty if the method takes none.
    figure : Figure or None
        None if no public figure is known.
    seconds : float or None
        CPU seconds of a run at 854x480 on one core; None if not measured.
    frames : str
        ``frame``, or ``section`` if only the first frame of each section is processed.
    licence : str
        Of the weights, or of the code of a method without any.
    """

    choice: str
    option: str
    weights: str
    figure: Figure | None
    seconds: float | None
    frames: str
    licence: str


def list_merits(items: Mapping[str, WeightsItem]) -> list[Merit]:
    """Return a row for each method of a choice between networks, and for each weights item that a method can read."""
    costs, rows = read_costs(), []
    for choice in all_choices():
        if all(backend.network is None for backend in choice.backends):
            continue
        frames = "section" if choice.is_once_a_section else "frame"
        for backend in choice.backends:
            option = choice.option_of(backend)
            if backend.network is not None:
                for item in items.values():
                    if item.architecture == backend.network.architecture:
                        seconds = costs.get(item.name + backend.cost_suffix)
                        figure = FIGURES.get(item.name)
                        rows.append(Merit(choice.name, option, item.name, figure, seconds, frames, item.licence))
            elif backend.method not in GIVEN:
                rows.append(Merit(choice.name, option, "", None, None, frames, backend.code))
    return rows


class Sum(NamedTuple):
    """CPU seconds a frame of the networks of a configuration, and those whose cost was not measured."""

    seconds: float
    unmeasured: tuple[str, ...]


def sum_costs(config: PipelineConfig, light: bool = False) -> Sum:
    """Return the cost of the networks of a configuration, at 854x480 on one core.

    Flow is counted in both directions where objects are found by their motion.

    Parameters
    ----------
    light : bool
        Whether the configuration has the parameters of a preset's lighter networks.
    """
    costs, seconds, unmeasured = read_costs(), 0.0, []
    directions = 2 if config.proposal_source in MOVING_SOURCES else 1
    for choice, backend in _chosen(config):
        name = backend.network.item(config) + backend.cost_suffix
        found = costs.get(name + LIGHT, costs.get(name)) if light else costs.get(name)
        if found is None:
            unmeasured.append(name)
        else:
            found *= directions if choice.name == "flow" else 1
            seconds += found / config.sections.length if choice.is_once_a_section else found
    return Sum(seconds, tuple(unmeasured))


def _chosen(config: PipelineConfig) -> Iterator[tuple[Choice, Backend]]:
    """Yield the networks that a configuration runs."""
    for stage in STAGES.values():
        method = stage.chosen(config)
        # Methods that compute nothing have no task.
        network = next((task.network for task in stage.tasks if task.method == method), None)
        if network is None:
            continue
        for choice in stage.choices:
            # One network can have several methods, of which the parameter names one.
            names = {method, choice.value_in(config)}
            yield from ((choice, each) for each in choice.backends if each.method in names and each.network == network)
