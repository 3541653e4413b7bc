"""Execution of recipes: inputs from the store, the task's function, its outputs into the store."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import NamedTuple

import numpy as np

from moseg.schemas.arrays import round_arrays
from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, StoreError
from moseg.schemas.events import EventKind
from moseg.schemas.recipes import Recipe
from moseg.store import PutOutcome, open_store
from moseg.workflows.engine.ingest import IngestJob, run_ingest
from moseg.workflows.engine.task_outputs import check_outputs
from moseg.workflows.engine.write_behind import Put, WriteBehind
from moseg.workflows.runlog.degeneracy import degenerate_event
from moseg.workflows.runlog.events import EventLog, failed_event, note_written, work_event
from moseg.workflows.stages.array_cache import ARRAYS
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.registry import find_task, layouts_of
from moseg.workflows.weights.reading import require_network_packages


class TaskReport(NamedTuple):
    """The result of a task as the client receives it: never arrays."""

    ref: str
    seconds: float
    outcome: str


def execute_batches(store_url: str, batches: Sequence[Sequence[Recipe]], run_id: str | None = None) -> list[TaskReport]:
    """Compute batches one after the other, each of recipes that differ in their inputs only, and write the events to
    the log of `run_id`."""
    # Never created here: on a machine that does not share the folder it would take results that nobody finds.
    store = open_store(store_url, create=False)
    reports: list[TaskReport] = []
    with EventLog(store, run_id) as log:

        def report(put: Put) -> None:
            ref = put.recipe.ref
            with _logged_failures(log, [put.recipe]):
                outcome = put.outcome.result()
            if outcome == PutOutcome.LOST_RACE:
                # Others read the stored arrays, not these.
                ARRAYS.drop(store.url, ref)
            reports.append(TaskReport(ref, put.seconds, outcome))
            events = [work_event(EventKind.COMPUTED, ref, put.seconds)]
            degenerate = degenerate_event(ref, put.recipe.task, put.output.arrays)
            if degenerate is not None:
                events.append(degenerate)
            # A put's outcomes have the names of their events.
            log.add(*events, work_event(EventKind(outcome), ref))

        # All at once, before the work: so they are in the log if the process is killed, even if an append is a request.
        log.write(work_event(EventKind.STARTED, recipe.ref) for batch in batches for recipe in batch)
        with WriteBehind(store, report) as behind:
            for batch in batches:
                reports.extend(_execute_batch(behind, batch, log))
    return reports


def execute_clip(store_url: str, recipes: Sequence[Recipe], run_id: str | None = None) -> list[TaskReport]:
    """Compute the recipes of a brief clip, see `execute_batches`, and drop its arrays from this process's cache.

    No other call reads them, and memory that is used again takes less time than fresh memory.
    """
    reports = execute_batches(store_url, [[recipe] for recipe in recipes], run_id)
    url = open_store(store_url, create=False).url
    for ref in {ref for recipe in recipes for ref in (recipe.ref, *recipe.input_refs())}:
        ARRAYS.drop(url, ref)
    return reports


def execute_ingest(
    store_url: str, batches: Sequence[Sequence[tuple[IngestJob, Recipe]]], run_id: str
) -> dict[str, dict]:
    """Decode batches of sources one after the other, see `run_ingest`, and write the events to the log of `run_id`."""
    store = open_store(store_url, create=False)
    remembered: dict[str, dict] = {}
    with EventLog(store, run_id) as log:
        log.write(work_event(EventKind.STARTED, recipe.ref) for batch in batches for _, recipe in batch)
        for batch in batches:
            recipes = [recipe for _, recipe in batch]
            with _logged_failures(log, recipes):
                started = time.perf_counter()
                remembered |= run_ingest(store, batch)
                seconds = (time.perf_counter() - started) / len(batch)
            for recipe in recipes:
                ref = recipe.ref
                log.add(work_event(EventKind.COMPUTED, ref, seconds), work_event(EventKind.COMMITTED, ref))
    return remembered


def seeded_generator(key: str) -> np.random.Generator:
    """Return the generator of a recipe: the same key draws the same numbers on any worker, in any order."""
    return np.random.default_rng(int(key, 16))


def _execute_batch(store: WriteBehind, recipes: Sequence[Recipe], log: EventLog) -> list[TaskReport]:
    """Compute the artifacts of recipes, except those that another process has stored, which are returned."""
    stored = [recipe for recipe in recipes if store.has(recipe.ref)]
    missing = [recipe for recipe in recipes if recipe not in stored]
    if missing:
        started = time.perf_counter()
        with _logged_failures(log, missing), _explained_failures(missing[0]):
            params = dict(missing[0].params)
            task = find_task(missing[0].task, params.pop("method"))
            inputs = [Inputs(store, recipe) for recipe in missing]
            outputs = task.compute(params, inputs, [seeded_generator(recipe.key) for recipe in missing])
            check_outputs(missing, outputs, is_plugin="code" in missing[0].params)
        seconds = (time.perf_counter() - started) / len(missing)
        for recipe, computed in zip(missing, outputs, strict=True):
            output = computed._replace(arrays=round_arrays(computed.arrays, layouts_of(recipe.task)))
            ARRAYS.keep(store.url, recipe.ref, output.arrays)
            store.put(recipe, output, seconds)
    log.add(*(work_event(EventKind.LOST_RACE, recipe.ref) for recipe in stored))
    return [TaskReport(recipe.ref, 0.0, PutOutcome.LOST_RACE) for recipe in stored]


@contextmanager
def _logged_failures(log: EventLog, recipes: Sequence[Recipe]) -> Iterator[None]:
    """Write failures of the block to the log; the client repairs a damaged or lost input, which is no failure."""
    try:
        yield
    except (CorruptArtifactError, MissingArtifactError):
        raise
    except Exception as error:
        # Keep the original error if logging also fails.
        with suppress(StoreError):
            log.write(failed_event(error, recipe.ref) for recipe in recipes)
            note_written(error, *(recipe.ref for recipe in recipes))
        raise


@contextmanager
def _explained_failures(recipe: Recipe) -> Iterator[None]:
    """Raise InputError if the block misses packages or memory for the network of a recipe."""
    try:
        yield
    except ModuleNotFoundError:
        # A worker of another machine may miss packages that the client has.
        require_network_packages()
        raise
    except RuntimeError as error:
        # The class is torch's, which is not imported for this.
        if type(error).__name__ != "OutOfMemoryError":
            raise
        expected = "--batch 1, or less by the network's parameters (max_side, …_per_pass)"
        where = f"{recipe.task} by {recipe.params['method']}"
        raise InputError("the GPU's memory does not hold it", where=where, got=error, expected=expected) from error
