"""The calls that decode sources or compute one phase of a plan: which jobs or recipes each of them takes."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeVar

from moseg.schemas.digests import canonical_json
from moseg.schemas.recipes import Recipe
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.runners import Runner
from moseg.workflows.engine.brief_clips import split_brief_clips
from moseg.workflows.engine.execution import execute_batches, execute_clip, execute_ingest
from moseg.workflows.engine.ingest import IngestJob
from moseg.workflows.engine.phases import network_of
from moseg.workflows.stages.registry import find_task

GPU_BATCH = 8
"""Frames that a GPU is given at once unless the user chooses: RAFT then takes some 4 GB at 1024x576."""
CHEAP_PER_CALL = 24
"""Flows both ways and saliency of eight frames: a second of work, so that the scheduler's time is negligible."""
CALLS_PER_WORKER = 8
"""Calls that each worker should get at least, so that all end at about the same time."""

Item = TypeVar("Item")


def make_ingest_calls(
    missing: Mapping[str, tuple[IngestJob, Recipe]], runner: Runner, store_url: str, run_id: str
) -> Iterator[Call]:
    """Yield the calls that decode the sources of jobs, each with its recipe, by reference."""
    batches: dict[str, list[tuple[IngestJob, Recipe]]] = {}
    for ref, (job, recipe) in missing.items():
        batches.setdefault(job.batch or ref, []).append((job, recipe))

    def is_cheap(item: tuple[IngestJob, Recipe]) -> bool:
        return item[0].is_cheap

    num_cheap = sum(is_cheap(batch[0]) for batch in batches.values())
    for joined in batch_cheap(batches.values(), is_cheap, _share(num_cheap, runner)):
        name = _call_name(joined[0][0][1])
        yield Call(name, execute_ingest, (store_url, tuple(map(tuple, joined)), run_id))


def make_calls(
    recipes: Mapping[str, Recipe], runner: Runner, store_url: str, run_id: str, batch: int | None = None
) -> Iterator[Call]:
    """Yield the calls that compute the recipes of one phase.

    Parameters
    ----------
    recipes : mapping of reference to recipe
        In an order in which each follows its inputs.
    batch : int, optional
        Recipes of a network that are computed at once; by default `GPU_BATCH` on a GPU, else 1.
    """
    batch_size = batch or 1
    if batch is None and any(network_of(recipe) is not None for recipe in recipes.values()):
        batch_size = GPU_BATCH if runner.has_gpu() else 1

    def size(recipe: Recipe) -> int:
        task = find_task(recipe.task, recipe.params["method"])
        return 1 if task.run_together is None else batch_size

    def is_cheap(recipe: Recipe) -> bool:
        return find_task(recipe.task, recipe.params["method"]).is_cheap

    def is_brief(recipe: Recipe) -> bool:
        return find_task(recipe.task, recipe.params["method"]).is_brief

    clips, recipes = split_brief_clips(recipes, is_brief, CALLS_PER_WORKER * runner.num_workers())
    for clip in clips:
        yield Call(_call_name(clip[0]), execute_clip, (store_url, tuple(clip), run_id))

    call_of: dict[str, str] = {}
    share = _share(sum(map(is_cheap, recipes.values())), runner)
    for batches in batch_cheap(batch_recipes(recipes, size), is_cheap, share):
        name = _call_name(batches[0][0])
        computed = [recipe for batch in batches for recipe in batch]
        parents = dict.fromkeys(
            call_of[parent] for recipe in computed for parent in recipe.input_refs() if parent in call_of
        )
        call_of |= {recipe.ref: name for recipe in computed}
        arguments = (store_url, tuple(map(tuple, batches)), run_id)
        yield Call(name, execute_batches, arguments, tuple(parents), network_of(computed[0]) is not None)


def batch_recipes(recipes: Mapping[str, Recipe], size: Callable[[Recipe], int]) -> Iterator[list[Recipe]]:
    """Yield batches of at most `size` recipes that differ in their inputs only.

    A recipe that reads another one's result is alone. Batches follow those that they wait for.
    """
    groups: dict[object, list[Recipe]] = {}
    for ref, recipe in recipes.items():
        is_alone = size(recipe) == 1 or any(parent in recipes for parent in recipe.input_refs())
        kind = (recipe.task, recipe.version, canonical_json(recipe.params), recipe.inputs.get("weights"))
        groups.setdefault(ref if is_alone else kind, []).append(recipe)
    for group in groups.values():
        step = size(group[0])
        for start in range(0, len(group), step):
            yield group[start : start + step]


def batch_cheap(
    batches: Iterable[list[Item]], is_cheap: Callable[[Item], bool], max_batches: int
) -> Iterator[list[list[Item]]]:
    """Yield the batches that one call computes one after the other.

    Up to `max_batches` cheap ones that follow each other share a call, any other batch is alone. If the plan goes from
    frame to frame, a call so processes neighbouring frames, whose images and flows stay in its process. Calls follow
    those that they wait for as long as the batches do.
    """
    joined: list[list[Item]] = []
    for batch in batches:
        if not is_cheap(batch[0]):
            if joined:
                yield joined
                joined = []
            yield [batch]
            continue
        joined.append(batch)
        if len(joined) == max_batches:
            yield joined
            joined = []
    if joined:
        yield joined


def _share(num_cheap: int, runner: Runner) -> int:
    """Return how many cheap items share a call: with few in all, no worker should wait for the long call of another."""
    return min(max(num_cheap // (CALLS_PER_WORKER * runner.num_workers()), 1), CHEAP_PER_CALL)


def _call_name(first: Recipe) -> str:
    return first.ref.replace("/", "-")
