"""Computing one recipe: inputs out of the store, the task's function, its output into the store."""

import time
from typing import NamedTuple

import numpy as np

from schemas.errors import CorruptArtifactError
from schemas.recipes import Recipe
from store import PutOutcome, open_store
from workflows.stages.inputs import Inputs
from workflows.stages.registry import find_task


class TaskReport(NamedTuple):
    """What a task tells the client: never arrays."""

    ref: str
    seconds: float
    outcome: str


def execute_recipe(store_url: str, recipe: Recipe, *_dependencies: object) -> TaskReport:
    """Compute a recipe's artifact unless another process already has; `_dependencies` only order the graph."""
    store = open_store(store_url)
    if store.has(recipe.ref):
        return TaskReport(recipe.ref, 0.0, PutOutcome.LOST_RACE)
    params = dict(recipe.params)
    task = find_task(recipe.task, params.pop("method"))
    started = time.perf_counter()
    output = task.run(params, Inputs(store, recipe), seeded_generator(recipe.key))
    seconds = time.perf_counter() - started
    outcome = store.put(recipe, output.arrays, output.attributes, seconds=seconds)
    return TaskReport(recipe.ref, seconds, outcome)


def seeded_generator(key: str) -> np.random.Generator:
    """The generator of a recipe: the same key draws the same numbers on any worker, in any order."""
    return np.random.default_rng(int(key, 16))


def quarantine_corrupt(store_url: str, error: CorruptArtifactError) -> None:
    """Take the artifact that an error names out of service, so that the next plan counts it as a miss."""
    open_store(store_url).quarantine(error.ref, str(error))
