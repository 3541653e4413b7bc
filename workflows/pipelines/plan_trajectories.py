"""What an evaluation on labelled trajectories would compute and reuse, with nothing computed or stored."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, seeded_configs
from moseg.store import ArtifactStore
from moseg.workflows.datasets import TrajectorySource
from moseg.workflows.engine.session import StageUse
from moseg.workflows.graph import TrajectoryGraph
from moseg.workflows.pipelines.plan_evaluation import EmptyStore, count_uses, foresee_ingest
from moseg.workflows.pipelines.trajectory_leaves import make_trajectory_leaves, trajectory_jobs


def plan_trajectories(
    store: ArtifactStore | EmptyStore,
    sources: Sequence[TrajectorySource],
    config: PipelineConfig,
    variants: Sequence[TrajectoryVariant],
    seeds: Sequence[int] | None = None,
) -> dict[str, StageUse]:
    """Artifacts to compute and to reuse by stage; clips that were never ingested are decoded."""
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
