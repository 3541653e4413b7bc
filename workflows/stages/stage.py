"""Stage: its result, inputs and arrays, and the methods that compute it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import NamedTuple

from moseg.schemas.arrays import ArrayLayout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.stages.task import Network, Task

OWN = "this project, MIT"
OPENCV = "OpenCV, Apache-2.0"
TRANSFORMERS = "transformers, Apache-2.0"


class Backend(NamedTuple):
    """Backend: one way to get the result of a stage, and its line in `moseg backends`.

    Attributes
    ----------
    method : str
        Value of the parameter that chooses it.
    what : str
        Description in words.
    code : str
        Owner and licence of the code that computes it.
    network : Network or None
        None if it takes no weights.
    option : str
        Option that chooses it on the command line, if it is not the stage's option with the method.
    cost_suffix : str
        End of the name of its cost, after the name of the weights item, if a network is used in several ways.
    """

    method: str
    what: str
    code: str = OWN
    network: Network | None = None
    option: str = ""
    cost_suffix: str = ""


class Choice(NamedTuple):
    """Parameter that chooses between the methods of a stage.

    Attributes
    ----------
    name : str
        Name in `moseg backends`.
    parameter : str
        ``stage.name``, as ``--set`` takes it; empty if there is nothing to choose.
    option : str
        Option of the command line; ``--set stage.name=`` if the parameter has none of its own.
    backends : tuple of Backend
    is_once_a_section : bool
        Whether only the first frame of each section is processed.
    """

    name: str
    parameter: str
    option: str
    backends: tuple[Backend, ...]
    is_once_a_section: bool = False

    def option_of(self, backend: Backend) -> str:
        """Return the option that chooses a backend on the command line."""
        path = ":PATH" if backend.method == "folder" else ""
        space = "" if self.option.endswith("=") else " "
        return backend.option or f"{self.option}{space}{backend.method}{path}"

    def value_in(self, config: PipelineConfig) -> str | None:
        """Return the value of the parameter in a configuration; None if there is nothing to choose."""
        return attrgetter(self.parameter)(config) if self.parameter else None

    @property
    def names(self) -> tuple[str, ...]:
        """Values that the parameter accepts."""
        return tuple(backend.method for backend in self.backends if not backend.option)


@dataclass(frozen=True)
class Stage:
    """One stage of the graph.

    Attributes
    ----------
    name : str
        Name in recipes, references and keys.
    about : str
        Description of one of its artifacts, in a line.
    inputs : mapping of str to str
        Description of each role; a recipe leaves out the roles that its method does not read.
    arrays : mapping of str to ArrayLayout
        Arrays of an artifact.
    tasks : tuple of Task
        One for each method.
    method : function, optional
        Function that returns the method that a `PipelineConfig` chooses; not needed for a stage with one method.
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
        """Return the method that a configuration chooses; None if it chooses to compute nothing."""
        return self.tasks[0].method if self.method is None else self.method(config)

    def task(self, method: str) -> Task:
        """Return the task of a method; raises InputError if the stage has no such method."""
        for task in self.tasks:
            if task.method == method:
                return task
        known = " or ".join(sorted(task.method for task in self.tasks))
        raise InputError(f"unknown method of stage {self.name}", got=method, expected=known)
