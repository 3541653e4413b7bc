"""A task: a named, versioned adapter from a recipe's inputs to a pure function and back to arrays."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from workflows.stages.inputs import Inputs


class Output(NamedTuple):
    """What a task leaves in the store: arrays by name, and small results as attributes."""

    arrays: Mapping[str, np.ndarray]
    attributes: Mapping[str, Any] = {}


@dataclass(frozen=True)
class Task:
    """One way (`method`) to do one stage (`name`).

    `version` rises whenever the code behind it may give other bytes; a test compares it with a fingerprint of the code.
    `run` takes the recipe's parameters, its inputs and a generator seeded by the recipe.
    """

    name: str
    method: str
    version: int
    run: Callable[[Mapping[str, Any], Inputs, np.random.Generator], Output]
