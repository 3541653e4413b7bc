"""A task: a named, versioned adapter from a recipe's inputs to a pure function and back to arrays."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from moseg.workflows.stages.inputs import Inputs


class Output(NamedTuple):
    """What a task leaves in the store: arrays by name, and small results as attributes."""

    arrays: Mapping[str, np.ndarray]
    attributes: Mapping[str, Any] = {}


Run = Callable[[Mapping[str, Any], Inputs, np.random.Generator], Output]
RunTogether = Callable[[Mapping[str, Any], Sequence[Inputs]], Sequence[Output]]


@dataclass(frozen=True)
class Task:
    """One way (`method`) to do one stage (`name`).

    `version` rises whenever the code behind it may give other bytes; a test compares it with a fingerprint of the code.
    `run` takes the recipe's parameters, its inputs and a generator seeded by the recipe. A task that draws no random
    numbers may have `run_together` instead, which takes the inputs of several recipes of the same parameters.
    One that `is_brief` does a frame's share in a fraction of a second: several share a call.
    """

    name: str
    method: str
    version: int
    run: Run | None = None
    run_together: RunTogether | None = None
    is_brief: bool = False

    def compute(
        self, params: Mapping[str, Any], inputs: Sequence[Inputs], generators: Sequence[np.random.Generator]
    ) -> Sequence[Output]:
        """The outputs of recipes of the same parameters."""
        if self.run_together is not None:
            return self.run_together(params, inputs)
        return [self.run(params, each, rng) for each, rng in zip(inputs, generators, strict=True)]
