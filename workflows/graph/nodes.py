"""Nodes of a graph: the recipes written so far, and the writer of a stage's recipe."""

from collections import ChainMap
from collections.abc import Mapping, MutableMapping
from functools import cached_property
from inspect import signature
from typing import Any

from pydantic import ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.sequence_leaves import SequenceLeaves
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves
from moseg.workflows.stages.registry import find_stage
from moseg.workflows.stages.task import Task

Inputs = dict[str, str | tuple[str, ...]]


class Nodes:
    """Recipes of one sequence or clip under one configuration, by reference.

    Parameters
    ----------
    recipes : mapping of reference to Recipe, optional
        Those of other nodes, which these are to share.

    Attributes
    ----------
    leaves : SequenceLeaves or TrajectoryLeaves
    config : PipelineConfig
    recipes : mapping of reference to Recipe
        Written so far, also by the nodes that these were made from.
    """

    def __init__(
        self,
        leaves: SequenceLeaves | TrajectoryLeaves,
        config: PipelineConfig,
        recipes: MutableMapping[str, Recipe] | None = None,
    ):
        self.leaves = leaves
        self.config = config
        self.recipes: MutableMapping[str, Recipe] = {} if recipes is None else recipes
        self._without_place: dict[tuple[str, str | None], tuple[Recipe, dict[str, str]]] = {}

    def changed(
        self, leaves: SequenceLeaves, config: PipelineConfig, recipes: MutableMapping[str, Recipe] | None = None
    ) -> "Nodes":
        """Return nodes under another configuration, which have the recipes of these too, in `recipes` if it is given.

        These do not have what the new ones write: of a slider that is moved for hours, nothing is kept.
        """
        if recipes is None:
            recipes = ChainMap({}, *getattr(self.recipes, "maps", [self.recipes]))
        return Nodes(leaves, config, recipes)

    @cached_property
    def frames(self) -> tuple[str, ...]:
        """References of the frames that are analysed: those of the leaves, filled where these do not show the scene."""
        hidden = self.leaves.hidden()
        if not hidden:
            return self.leaves.frames
        method = "nearest-scene" if "graphics" in hidden else "border-replicated"
        return tuple(self.add("filled_frame", {"frame": frame}, method, **hidden) for frame in self.leaves.frames)

    def add(self, stage: str, inputs: Inputs, method: str | None = None, **place) -> str:
        """Write the recipe of a stage and return its reference.

        Parameters
        ----------
        inputs : dict of reference or tuple of references
            By role, without the weights.
        method : str, optional
            By default the one that the configuration chooses.
        place
            Parameters that depend on the place in the sequence; see the stage's `Task.params`.
        """
        if place:
            head, weights = self._head(stage, method, place)
        elif (stage, method) in self._without_place:
            head, weights = self._without_place[stage, method]
        else:
            head, weights = self._without_place[stage, method] = self._head(stage, method, place)
        recipe = head.about(inputs | weights)
        self.recipes[recipe.ref] = recipe
        return recipe.ref

    def required(self, leaf: str, option: str):
        """Return a given leaf that an option needs; raises InputError if the sequence lacks it."""
        value = getattr(self.leaves, leaf)
        if value is None:
            raise InputError(
                f"{option} needs {leaf.replace('_', ' ')} that the data set does not give",
                where=f"sequence {self.leaves.name}",
            )
        return value

    def _head(self, name: str, method: str | None, place: dict) -> tuple[Recipe, dict[str, str]]:
        """Return a recipe without inputs, and its input of weights, if it has one."""
        stage = find_stage(name)
        task = stage.task(stage.chosen(self.config) if method is None else method)
        if task.code is not None:
            _check_signature(task, place)
        read = task.params(self.config, **place)
        where = f"{name} by {task.method}"
        if not isinstance(read, Mapping):
            got = type(read).__name__
            raise InputError("parameters of a recipe that are no mapping", where=where, got=got, expected="a dict")
        params = {"method": task.method, **read}
        if task.code is not None:
            params["code"] = task.code
        weights = {} if task.network is None else {"weights": self.leaves.weights[task.network.item(self.config)]}
        try:
            return Recipe(task=name, version=task.version, params=params), weights
        except ValidationError as error:
            got = f"{'.'.join(map(str, error.errors()[0]['loc'][1:2]))} of {type(error.errors()[0]['input']).__name__}"
            expected = "names with texts, numbers, lists and mappings"
            raise InputError("parameters that JSON cannot hold", where=where, got=got, expected=expected) from error


def _check_signature(task: Task, place: Mapping[str, Any]) -> None:
    """Raise InputError if the function `params` of a plug-in's method does not take what the graph passes."""
    taken = signature(task.params)
    try:
        taken.bind(None, **place)
    except TypeError as error:
        got = f"def params{taken}"
        where, expected = f"{task.name} by {task.method}", ", ".join(["the configuration", *place])
        raise InputError(
            "params of a method that takes other arguments", where=where, got=got, expected=expected
        ) from error
