"""Evaluation on labelled trajectories: variants scored on clips, under one seed or several."""

from collections.abc import Sequence

from schemas.configs import PipelineConfig, TrajectoryVariant
from schemas.trajectory_scores import TrajectoryReport, TrajectoryRow, TrajectoryScore, average_clips, average_seeds
from workflows.datasets import TrajectorySource
from workflows.graph import TrajectoryGraph
from workflows.session import Session
from workflows.trajectory_leaves import ingest_trajectories


def evaluate_trajectories(
    session: Session,
    dataset: str,
    sources: Sequence[TrajectorySource],
    config: PipelineConfig,
    variants: Sequence[TrajectoryVariant],
    seeds: Sequence[int] | None = None,
) -> TrajectoryReport:
    """Score each variant on every clip; equal nodes of variants and seeds are computed once.

    Parameters
    ----------
    seeds : sequence of int, optional
        The report's figures are means over these. None: one run with the seed of `config`.

    Raises
    ------
    InputError
        A clip cannot be read.
    """
    configs = {seed: with_seed(config, seed) for seed in seeds} if seeds else {None: config}
    refs: dict[tuple[int | None, TrajectoryVariant, str], str] = {}

    def build():
        recipes = {}
        for leaves in ingest_trajectories(session, sources):
            for seed, seeded in configs.items():
                graph = TrajectoryGraph(leaves, seeded)
                for variant in variants:
                    refs[seed, variant, leaves.name] = graph.score(variant)
                recipes |= graph.recipes
        return recipes, tuple(refs.values())

    def read():
        return {ref: TrajectoryScore(**session.store.attributes(ref)) for ref in refs.values()}

    by_ref = session.compute(build, read)
    rows = []
    for variant in variants:
        by_seed = {
            seed: {source.name: by_ref[refs[seed, variant, source.name]] for source in sources} for seed in configs
        }
        rows.append(_row(variant, by_seed))
    return TrajectoryReport(dataset=dataset, rows=tuple(rows), store=session.use(), seconds=session.seconds)


def with_seed(config: PipelineConfig, seed: int) -> PipelineConfig:
    """The configuration with another seed."""
    return config.model_copy(update={"hypotheses": config.hypotheses.model_copy(update={"seed": seed})})


def _row(variant: TrajectoryVariant, by_seed: dict[int | None, dict[str, TrajectoryScore]]) -> TrajectoryRow:
    if None not in by_seed:
        return average_seeds(variant.value, by_seed)
    scores = by_seed[None]
    return TrajectoryRow(variant=variant.value, sequences=scores, mean=average_clips(list(scores.values())))
