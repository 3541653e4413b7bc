"""The nodes written so far, and what every part of the graph needs to write one."""

from collections.abc import Set

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.frozen import Frozen
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.sequence_leaves import SequenceLeaves
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves
from moseg.workflows.stages.registry import find_task


class Nodes:
    """Recipes of one sequence or clip under one configuration, by reference."""

    def __init__(self, leaves: SequenceLeaves | TrajectoryLeaves, config: PipelineConfig):
        self.leaves = leaves
        self.config = config
        self.recipes: dict[str, Recipe] = {}

    def add(self, name: str, method: str, params: dict, inputs: dict) -> str:
        """Reference of a stage's recipe."""
        return self.add_like(self.kind(name, method, params), inputs)

    def kind(self, name: str, method: str, params: dict) -> Recipe:
        """What nodes of a stage with the same parameters have in common: a recipe without inputs, for `add_like`."""
        return Recipe(task=name, version=find_task(name, method).version, params={"method": method, **params})

    def add_like(self, kind: Recipe, inputs: dict) -> str:
        """Reference of a recipe of this kind."""
        recipe = kind.about(inputs)
        self.recipes[recipe.ref] = recipe
        return recipe.ref

    def network(self, method: str, unread: Set[str] = frozenset()) -> tuple[dict, str]:
        """The parameters that a network reads, under its name, and its weights; `unread` are of its other uses."""
        name = method.replace("-", "_")
        params: Frozen = getattr(self.config, name)
        return {name: params.model_dump(mode="json", exclude={"weights", *unread})}, self.weights(params.weights)

    def weights(self, item: str) -> str:
        """Reference of a weights item."""
        return self.leaves.weights[item]

    def required(self, leaf: str, option: str):
        """A leaf that an option takes as given; raises InputError where the sequence lacks it."""
        value = getattr(self.leaves, leaf)
        if value is None:
            raise InputError(
                f"{option} needs {leaf.replace('_', ' ')} that the data set does not give",
                where=f"sequence {self.leaves.name}",
            )
        return value
