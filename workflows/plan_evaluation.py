"""What an evaluation would compute and reuse, with nothing computed or stored."""

import os
from collections.abc import Sequence

from schemas.configs import PipelineConfig, Variant
from schemas.errors import CorruptArtifactError, MissingArtifactError
from store import ArtifactStore
from workflows.datasets import SequenceSource
from workflows.graph import SequenceGraph
from workflows.ingest import IngestJob, preview_ingest, recall_ingest
from workflows.leaves import ingest_jobs, make_leaves
from workflows.planning import make_plan
from workflows.session import StageUse
from workflows.weights.folder import open_weights
from workflows.weights.leaf import weights_leaf
from workflows.weights.needed import needed_items


class EmptyStore:
    """Stands for a store that does not exist yet: nothing can be reused."""

    def has(self, ref: str) -> bool:
        """Never."""
        return False


def plan_evaluation(
    store: ArtifactStore | EmptyStore,
    sources: Sequence[SequenceSource],
    config: PipelineConfig,
    variants: Sequence[Variant],
) -> dict[str, StageUse]:
    """Artifacts to compute and to reuse by stage.

    Frames that were never ingested are decoded, because keys are digests of what files decode to.
    """
    folder = open_weights(os.environ, offline=True)
    weights = {
        name: weights_leaf(folder, name, architecture)[0].ref for name, architecture in needed_items(config).items()
    }
    recipes, sinks, num_ingests = {}, [], 0
    for source in sources:
        ingested = {}
        for role, jobs in ingest_jobs(source, config, annotated=True).items():
            known = [_recall(store, job) for job in jobs]
            num_ingests += known.count(None)
            ingested[role] = [
                preview_ingest(job) if entry is None else entry for job, entry in zip(jobs, known, strict=True)
            ]
        graph = SequenceGraph(make_leaves(source, ingested)._replace(weights=weights), config)
        sinks.extend(graph.score(variant) for variant in variants)
        sinks.extend(graph.cues())
        recipes |= graph.recipes
    computed, reused = make_plan(store, recipes, sinks).count()
    if num_ingests:
        computed["ingest"] = num_ingests
    names = dict.fromkeys([*computed, *reused])
    return {name: StageUse(computed[name], reused[name], 0.0) for name in names}


def _recall(store: ArtifactStore | EmptyStore, job: IngestJob) -> dict | None:
    """What is remembered of a job; a run would quarantine a damaged memory and ingest anew."""
    try:
        return recall_ingest(store, job.recipe)
    except (CorruptArtifactError, MissingArtifactError):
        return None
