"""Stage: what it computes, from which inputs, which arrays it leaves, and the methods that it can be computed by."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from moseg.schemas.arrays import ArrayLayout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.stages.task import Network, Task

OWN = "this project, MIT"
OPENCV = "OpenCV, Apache-2.0"
TRANSFORMERS = "transformers, Apache-2.0"


class Backend(NamedTuple):
    """A line of `moseg backends`: one way to get the result of a stage.

    Attributes
    ----------
    method : str
        Value of the parameter that chooses it.
    what : str
        In words.
    code : str
        Whose code computes it, and its licence.
    network : Network or None
        None if it takes no weights.
    option : str
        Chooses it on the command line, if this is not the stage's option with the method.
    """

    method: str
    what: str
    code: str = OWN
    network: Network | None = None
    option: str = ""


class Choice(NamedTuple):
    """A parameter that chooses between the methods of a stage.

    Attributes
    ----------
    name : str
        In `moseg backends`.
    parameter : str
        ``stage.name``, as ``--set`` takes it; empty if there is nothing to choose.
    option : str
        Of the command line.
    backends : tuple of Backend
    """

    name: str
    parameter: str
    option: str
    backends: tuple[Backend, ...]

    def option_of(self, backend: Backend) -> str:
        """Return how a backend is chosen on the command line."""
        path = ":PATH" if backend.method == "folder" else ""
        return backend.option or f"{self.option} {backend.method}{path}"

    @property
    def names(self) -> tuple[str, ...]:
        """Values of the parameter."""
        return tuple(backend.method for backend in self.backends if not backend.option)


@dataclass(frozen=True)
class Stage:
    """One stage of the graph.

    Attributes
    ----------
    name : str
        In recipes, references and keys.
    about : str
        What one artifact of it is, in a line.
    inputs : mapping of str to str
        What each role holds; a role that a method does not read is left out of its recipe.
    arrays : mapping of str to ArrayLayout
        What an artifact holds.
    tasks : tuple of Task
        One for each method.
    method : function, optional
        Returns the method that a `PipelineConfig` chooses; not needed for a stage of a single one.
    choices : tuple of Choice
        Parameters that choose the method.
    """

    name: str
    about: str
    inputs: Mapping[str, str]
    arrays: Mapping[str, ArrayLayout]
    tasks: tuple[Task, ...]
    method: Callable[[PipelineConfig], str | None] | None = None
    choices: tuple[Choice, ...] = ()

    def chosen(self, config: PipelineConfig) -> str | None:
        """Return the method that a configuration chooses; None if nothing is computed under it."""
        return self.tasks[0].method if self.method is None else self.method(config)

    def task(self, method: str) -> Task:
        """Return the task of a method; raises InputError if the stage has no such method."""
        for task in self.tasks:
            if task.method == method:
                return task
        known = " or ".join(sorted(task.method for task in self.tasks))
        raise InputError(f"unknown method of stage {self.name}", got=method, expected=known)
