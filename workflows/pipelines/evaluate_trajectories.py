"""Evaluation on labelled trajectories: variants scored on clips, under one seed or several."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, seeded_configs
from moseg.schemas.recipes import Recipe
from moseg.schemas.trajectory_scores import (
    TrajectoryReport,
    TrajectoryScore,
    average_row,
)
from moseg.workflows.datasets import TrajectorySource
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import TrajectoryGraph
from moseg.workflows.pipelines.failed_sequence import name_failed_sequence
from moseg.workflows.pipelines.leaves import ingest_trajectories
from moseg.workflows.pipelines.purpose import EVALUATION, Purpose, make_subject
from moseg.workflows.reports.panels import Panels


def evaluate_trajectories(
    session: Session,
    dataset: str,
    sources: Sequence[TrajectorySource],
    config: PipelineConfig,
    variants: Sequence[TrajectoryVariant],
    seeds: Sequence[int] | None = None,
    purpose: Purpose = EVALUATION,
    panels: Panels | None = None,
) -> TrajectoryReport:
    """Score each variant on every clip; equal nodes of variants and seeds are computed once.

    Parameters
    ----------
    seeds : sequence of int, optional
        The report's figures are means over these. None: one run with the seed of `config`.
    purpose : Purpose
        What the run's log records about it.
    panels : Panels, optional
        Gather what a report shows, under the first seed.

    Raises
    ------
    InputError
        A clip cannot be read.
    """
    configs = seeded_configs(config, seeds)
    first = next(iter(configs))
    shown: list[TrajectoryGraph] = []
    refs: dict[tuple[int | None, TrajectoryVariant, str], str] = {}
    recipes: dict[str, Recipe] = {}
    sinks_of: dict[str, list[str]] = {}

    def build():
        more = []
        shown.clear()
        recipes.clear()
        sinks_of.clear()
        clips = ingest_trajectories(session, sources)
        for leaves in clips:
            for seed, seeded in configs.items():
                graph = TrajectoryGraph(leaves, seeded)
                for variant in variants:
                    refs[seed, variant, leaves.name] = score = graph.score(variant)
                    sinks_of.setdefault(leaves.name, []).append(score)
                if panels is not None and seed == first and panels.shows(leaves.name):
                    shown.append(graph)
                    more.extend(panels.sinks(graph))
                recipes.update(graph.recipes)
        session.log.describe(
            make_subject(purpose, dataset, config, variants, [(leaves, None) for leaves in clips], seeds)
        )
        return recipes, (*refs.values(), *more)

    def read():
        scores = {ref: TrajectoryScore(**session.store.attributes(ref)) for ref in refs.values()}
        for graph in shown:
            panels.gather(session.store, graph)
        return scores

    by_ref = session.compute(build, read, restated=name_failed_sequence(recipes, sinks_of))
    rows = []
    for variant in variants:
        by_seed = {
            seed: {source.name: by_ref[refs[seed, variant, source.name]] for source in sources} for seed in configs
        }
        rows.append(average_row(variant.value, by_seed, {source.name: source.groups for source in sources}))
    return TrajectoryReport(
        dataset=dataset, rows=tuple(rows), store=session.use(), seconds=session.seconds, notes=purpose.notes
    )
