"""What an evaluation would compute and reuse, with nothing computed or stored."""

from collections.abc import Iterable, Mapping, Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant, seeded_configs
from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError, MissingInputError
from moseg.schemas.recipes import Recipe
from moseg.store import ArtifactStore
from moseg.workflows.datasets import SequenceSource, TrajectorySource, find_ground_truth
from moseg.workflows.engine.ingest import IngestJob, preview_ingest, recall_ingests
from moseg.workflows.engine.planning import make_plan
from moseg.workflows.engine.session import StageUse
from moseg.workflows.graph import SequenceGraph, TrajectoryGraph
from moseg.workflows.pipelines.leaves import ingest_jobs, make_leaves, make_trajectory_leaves, trajectory_jobs
from moseg.workflows.pipelines.repeated_frames import repetition_writers, with_repetitions
from moseg.workflows.pipelines.slow_motion import gap_writers, with_gaps
from moseg.workflows.pipelines.source_choices import choice_recipes, with_choices
from moseg.workflows.stages.needed_weights import needed_items
from moseg.workflows.weights.folder import Weights, weights_leaf
from moseg.workflows.weights.leaves_by_name import LeavesByName, absent_leaf


class EmptyStore:
    """Stands for a store that does not exist yet: nothing can be reused."""

    def present(self, refs: Iterable[str]) -> set[str]:
        """Return no reference."""
        return set()


def plan_evaluation(
    store: ArtifactStore | EmptyStore,
    sources: Sequence[SequenceSource],
    config: PipelineConfig,
    variants: Sequence[Variant],
    folder: Weights,
) -> tuple[dict[str, StageUse], tuple[str, ...], int]:
    """Return the artifacts to compute and to reuse by stage, the weights items read, and the number of open choices.

    Where such a choice is not stored, the rest is counted as if saliency were chosen, and where frames that repeat
    others, or slow motion, were not looked for, as if there were none but frames that are the same. Frames that were
    never ingested are decoded, because keys are digests of what files decode to. With weights that are neither here nor
    pinned nothing can have been made.

    Raises
    ------
    InputError
        Where the evaluation would have nothing to score against.
    """
    find_ground_truth(sources)
    weights = LeavesByName(needed_items(config), lambda name, needed: _plan_weights(folder, name, needed))
    leaves, num_ingests = [], 0
    for source in sources:
        ingested = {}
        for role, jobs in ingest_jobs(source, config, annotated=True).items():
            ingested[role], num_new = foresee_ingest(store, jobs)
            num_ingests += num_new
        leaves.append(make_leaves(source, ingested)._replace(weights=weights))
    writers = repetition_writers(leaves, config)
    sinks = [ref for writer in writers for ref in writer.refs()]
    recipes = {ref: recipe for writer in writers for ref, recipe in writer.recipes.items()}
    leaves = with_repetitions(leaves, writers, _known(store, sinks))
    gaps = gap_writers(leaves, config)
    gap_refs = [ref for writer in gaps for ref in writer.refs()]
    recipes |= {ref: recipe for writer in gaps for ref, recipe in writer.recipes.items()}
    sinks.extend(gap_refs)
    leaves = with_gaps(leaves, gaps, _known(store, gap_refs))
    written = choice_recipes(leaves, config)
    known = _known(store, written.sinks)
    recipes |= written.recipes
    sinks.extend(written.sinks)
    for each in with_choices(leaves, config, written, known):
        graph = SequenceGraph(each, config)
        sinks.extend(graph.score(variant) for variant in variants)
        sinks.extend(graph.cues())
        recipes |= graph.recipes
    num_unknown = sum(ref not in known for ref in written.sinks)
    return count_uses(store, recipes, sinks, num_ingests), weights.read, num_unknown


def plan_trajectories(
    store: ArtifactStore | EmptyStore,
    sources: Sequence[TrajectorySource],
    config: PipelineConfig,
    variants: Sequence[TrajectoryVariant],
    seeds: Sequence[int] | None = None,
) -> dict[str, StageUse]:
    """Return the artifacts to compute and to reuse by stage; clips that were never ingested are decoded."""
    recipes, sinks, num_ingests = {}, [], 0
    for source in sources:
        entries, num_new = foresee_ingest(store, trajectory_jobs(source))
        num_ingests += num_new
        leaves = make_trajectory_leaves(source, *entries)
        for seeded in seeded_configs(config, seeds).values():
            graph = TrajectoryGraph(leaves, seeded)
            sinks.extend(graph.score(variant) for variant in variants)
            recipes |= graph.recipes
    return count_uses(store, recipes, sinks, num_ingests)


def foresee_ingest(store: ArtifactStore | EmptyStore, jobs: Sequence[IngestJob]) -> tuple[list[dict], int]:
    """Return what ingesting the jobs would give, and how many of them a run would have to decode."""
    recipes = [job.recipe for job in jobs]
    known = recall_ingests(store, recipes, _remembered)
    memories = [known[recipe.ref] for recipe in recipes]
    found = [preview_ingest(job) if memory is None else memory for job, memory in zip(jobs, memories, strict=True)]
    return found, memories.count(None)


def count_uses(
    store: ArtifactStore | EmptyStore, recipes: Mapping[str, Recipe], sinks: Sequence[str], num_ingests: int
) -> dict[str, StageUse]:
    """Return the artifacts to compute and to reuse by stage."""
    computed, reused = make_plan(store, recipes, sinks).count()
    if num_ingests:
        computed["ingest"] = num_ingests
    names = dict.fromkeys([*computed, *reused])
    return {name: StageUse(computed[name], reused[name], 0.0) for name in names}


def _known(store: ArtifactStore | EmptyStore, refs: Sequence[str]) -> dict[str, dict]:
    """Return the attributes of what is stored, by reference."""
    return {ref: found for ref in store.present(refs) if (found := _remembered(store, ref)) is not None}


def _plan_weights(folder: Weights, name: str, architecture: str) -> str:
    """Return the reference of a weights item's leaf; one that no artifact has where its digest is not known yet."""
    try:
        return weights_leaf(folder, name, architecture).recipe.ref
    except MissingInputError:
        return absent_leaf(name)


def _remembered(store: ArtifactStore, ref: str) -> dict | None:
    """Return what is remembered under a reference; a run would quarantine a damaged entry and ingest again."""
    try:
        return store.attributes(ref)
    except (CorruptArtifactError, MissingArtifactError):
        return None
