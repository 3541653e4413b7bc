"""Computing recipes: inputs out of the store, the task's function, its outputs into the store."""

import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from schemas.errors import CorruptArtifactError, InputError
from schemas.recipes import Recipe
from store import ArtifactStore, PutOutcome, open_store
from workflows.stages.array_cache import ARRAYS
from workflows.stages.inputs import Inputs
from workflows.stages.registry import find_task
from workflows.stages.task import Output
from workflows.weights.packages import require_network_packages


class TaskReport(NamedTuple):
    """What a task tells the client: never arrays."""

    ref: str
    seconds: float
    outcome: str


def execute_batches(store_url: str, batches: Sequence[Sequence[Recipe]], *_dependencies: object) -> list[TaskReport]:
    """Compute batches one after the other, each of recipes that differ in their inputs only; `_dependencies` only order
    the graph."""
    store = open_store(store_url)
    return [report for batch in batches for report in execute_recipes(store, batch)]


def execute_recipes(store: ArtifactStore, recipes: Sequence[Recipe]) -> list[TaskReport]:
    """Compute the artifacts of recipes that differ in their inputs only, but for those that another process has
    computed."""
    stored = [recipe for recipe in recipes if store.has(recipe.ref)]
    missing = [recipe for recipe in recipes if recipe not in stored]
    reports = [TaskReport(recipe.ref, 0.0, PutOutcome.LOST_RACE) for recipe in stored]
    if missing:
        started = time.perf_counter()
        outputs = _run(store, missing)
        seconds = (time.perf_counter() - started) / len(missing)
        for recipe, output in zip(missing, outputs, strict=True):
            outcome = store.put(recipe, output.arrays, output.attributes, seconds=seconds)
            ARRAYS.keep(store, recipe.ref, output.arrays)
            reports.append(TaskReport(recipe.ref, seconds, outcome))
    return reports


def _run(store: ArtifactStore, recipes: Sequence[Recipe]) -> Sequence[Output]:
    params = dict(recipes[0].params)
    task = find_task(recipes[0].task, params.pop("method"))
    inputs = [Inputs(store, recipe) for recipe in recipes]
    try:
        return task.compute(params, inputs, [seeded_generator(recipe.key) for recipe in recipes])
    except ModuleNotFoundError:
        # A worker of another machine may lack what the client has.
        require_network_packages()
        raise
    except RuntimeError as error:
        # Of torch, which is not imported for it.
        if type(error).__name__ != "OutOfMemoryError":
            raise
        expected = "--batch 1, or less by the network's parameters (max_side, …_per_pass)"
        where = f"{recipes[0].task} by {task.method}"
        raise InputError("the GPU's memory does not hold it", where=where, got=error, expected=expected) from error


def seeded_generator(key: str) -> np.random.Generator:
    """The generator of a recipe: the same key draws the same numbers on any worker, in any order."""
    return np.random.default_rng(int(key, 16))


def quarantine_corrupt(store_url: str, error: CorruptArtifactError) -> None:
    """Take the artifact that an error names out of service, so that the next plan counts it as a miss."""
    open_store(store_url).quarantine(error.ref, str(error))
