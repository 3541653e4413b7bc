"""Task: one method of one stage, from the parameters that it reads to its output."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.stages.inputs import Inputs


class Output(NamedTuple):
    """Result of a task: arrays by name, and small results as attributes."""

    arrays: Mapping[str, np.ndarray]
    attributes: Mapping[str, Any] = {}


Run = Callable[[Mapping[str, Any], Inputs, np.random.Generator], Output]
RunTogether = Callable[[Mapping[str, Any], Sequence[Inputs]], Sequence[Output]]


class Network(NamedTuple):
    """Network that a task runs.

    Attributes
    ----------
    architecture : str
        Architecture of the weights that it takes.
    parameter : str
        ``stage.name`` of the parameter that names the weights item.
    default : str
        Item that is read if the parameter is empty.
    documents : tuple of str
        Files of the weights from which the network is built, in addition to its tensors.
    """

    architecture: str
    parameter: str
    default: str
    documents: tuple[str, ...] = ()

    def item(self, config: PipelineConfig) -> str:
        """Return the name of the weights item that a configuration chooses."""
        stage, _, name = self.parameter.partition(".")
        return getattr(getattr(config, stage), name) or self.default


def no_params(config: PipelineConfig, **place) -> dict:
    """Return the empty parameters of a task that reads none."""
    return {}


@dataclass(frozen=True)
class Task:
    """One method of one stage.

    Attributes
    ----------
    name, method : str
        Stage and method, as in the recipe.
    version : int
        Increased whenever the code of the task may give other bytes; a test compares it with a digest of the code.
    run : function, optional
        Takes the recipe's parameters, its inputs and a generator seeded by the recipe.
    run_together : function, optional
        Replaces `run` in a task that draws no random numbers: takes the inputs of several recipes with the same
        parameters.
    params : function
        Returns the parameters of the recipe from a `PipelineConfig`: exactly those that the task reads. The graph
        passes by keyword what depends on the place in the sequence.
    network : Network, optional
        Its weights are the input ``weights``.
    is_cheap : bool
        Whether one frame takes a fraction of a second, so that several recipes share a call.
    is_brief : bool
        Whether it takes about a second for a whole clip, so that one call computes all that is missing of a clip if
        there are many.
    is_cue : bool
        Whether its artifacts are dense maps that are large and cheap to compute again: `segment` lets go of them.
    code : str, optional
        Fingerprint of the plug-in that defines the task, set when it is registered; part of the recipes.
    """

    name: str
    method: str
    version: int
    run: Run | None = None
    run_together: RunTogether | None = None
    params: Callable[..., dict] = no_params
    network: Network | None = None
    is_cheap: bool = False
    is_brief: bool = False
    is_cue: bool = False
    code: str | None = None

    def compute(
        self, params: Mapping[str, Any], inputs: Sequence[Inputs], generators: Sequence[np.random.Generator]
    ) -> Sequence[Output]:
        """Return the outputs of recipes that have the same parameters.

        Raises
        ------
        InputError
            The recipe was written for a version of the plug-in's code that this process does not have.
        """
        params = dict(params)
        if self.code is not None and (wanted := params.pop("code", None)) != self.code:
            where, got = f"{self.name} by {self.method}", f"code {self.code}"
            raise InputError("another version of a plug-in", where=where, got=got, expected=f"code {wanted}")
        if self.run_together is not None:
            return self.run_together(params, inputs)
        return [self.run(params, each, rng) for each, rng in zip(inputs, generators, strict=True)]
