"""Computing recipes: inputs out of the store, the task's function, its outputs into the store."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, StoreError
from moseg.schemas.events import EventKind
from moseg.schemas.recipes import Recipe
from moseg.store import PutOutcome
from moseg.workflows.engine.ingest import IngestJob, open_existing, run_ingest
from moseg.workflows.engine.write_behind import Put, WriteBehind
from moseg.workflows.runlog.degeneracy import degenerate_event
from moseg.workflows.runlog.events import EventLog, failed_event, note_written, work_event
from moseg.workflows.stages.array_cache import ARRAYS
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.registry import find_task
from moseg.workflows.stages.task import Output
from moseg.workflows.weights.reading import require_network_packages


class TaskReport(NamedTuple):
    """What a task tells the client: never arrays."""

    ref: str
    seconds: float
    outcome: str


def execute_batches(store_url: str, batches: Sequence[Sequence[Recipe]], run_id: str | None = None) -> list[TaskReport]:
    """Compute batches one after the other, each of recipes that differ in their inputs only, and write the events to
    the log of `run_id`."""
    store = open_existing(store_url)
    reports: list[TaskReport] = []
    with EventLog(store, run_id) as log:

        def tell(put: Put) -> None:
            with _telling_failures(log, [put.recipe]):
                outcome = put.outcome.result()
            if outcome == PutOutcome.LOST_RACE:
                # What others read is what is stored.
                ARRAYS.drop(store.url, put.recipe.ref)
            reports.append(TaskReport(put.recipe.ref, put.seconds, outcome))
            _tell_stored(log, put.recipe, put.output, reports[-1])

        # All at once: what was in hand when a process is killed is known also where an append is a request.
        log.write(work_event(EventKind.STARTED, recipe.ref) for batch in batches for recipe in batch)
        with WriteBehind(store, tell) as behind:
            for batch in batches:
                reports.extend(_execute_batch(behind, batch, log))
    return reports


def _execute_batch(store: WriteBehind, recipes: Sequence[Recipe], log: EventLog) -> list[TaskReport]:
    """Compute the artifacts of recipes but for those that another process has computed, which are reported."""
    stored = [recipe for recipe in recipes if store.has(recipe.ref)]
    missing = [recipe for recipe in recipes if recipe not in stored]
    if missing:
        started = time.perf_counter()
        with _telling_failures(log, missing):
            outputs = _run(store, missing)
        seconds = (time.perf_counter() - started) / len(missing)
        for recipe, output in zip(missing, outputs, strict=True):
            ARRAYS.keep(store.url, recipe.ref, output.arrays)
            store.put(recipe, output, seconds)
    log.add(*(work_event(EventKind.LOST_RACE, recipe.ref) for recipe in stored))
    return [TaskReport(recipe.ref, 0.0, PutOutcome.LOST_RACE) for recipe in stored]


def execute_ingest(store_url: str, batch: Sequence[tuple[IngestJob, Recipe]], run_id: str) -> dict[str, dict]:
    """Decode a batch of sources, see `run_ingest`, and write the events to the log of `run_id`."""
    store = open_existing(store_url)
    recipes = [recipe for _, recipe in batch]
    with EventLog(store, run_id) as log:
        log.write(work_event(EventKind.STARTED, recipe.ref) for recipe in recipes)
        with _telling_failures(log, recipes):
            started = time.perf_counter()
            remembered = run_ingest(store_url, batch)
            seconds = (time.perf_counter() - started) / len(batch)
        for recipe in recipes:
            log.add(work_event(EventKind.COMPUTED, recipe.ref, seconds), work_event(EventKind.COMMITTED, recipe.ref))
    return remembered


def _tell_stored(log: EventLog, recipe: Recipe, output: Output, report: TaskReport) -> None:
    events = [work_event(EventKind.COMPUTED, recipe.ref, report.seconds)]
    degenerate = degenerate_event(recipe.ref, recipe.task, output.arrays)
    if degenerate is not None:
        events.append(degenerate)
    # A put's outcomes are named as the events that they are.
    log.add(*events, work_event(EventKind(report.outcome), recipe.ref))


@contextmanager
def _telling_failures(log: EventLog, recipes: Sequence[Recipe]) -> Iterator[None]:
    """Write to the log what fails in the block; a damaged or lost input is for the client to mend, and no failure."""
    try:
        yield
    except (CorruptArtifactError, MissingArtifactError):
        raise
    except Exception as error:
        # A disk that refuses the log too is not the news.
        with suppress(StoreError):
            log.write(failed_event(error, recipe.ref) for recipe in recipes)
            note_written(error, recipes[0].ref)
        raise


def _run(store: WriteBehind, recipes: Sequence[Recipe]) -> Sequence[Output]:
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


def quarantine_corrupt(store_url: str, error: CorruptArtifactError) -> bool:
    """Take the artifact that an error names out of service, so that the next plan counts it as a miss; False where
    another process already did."""
    return open_existing(store_url).quarantine(error.ref, str(error))
