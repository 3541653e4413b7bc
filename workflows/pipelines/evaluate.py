"""Evaluation: variants of the pipeline scored on a data set."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.recipes import Recipe
from moseg.schemas.scores import AnyReport, AnyScore, GroundTruth, make_report, score_class
from moseg.store import map_reads
from moseg.workflows.datasets import SequenceSource, find_ground_truth
from moseg.workflows.engine.session import Session
from moseg.workflows.engine.waves import in_waves
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.failed_sequence import name_failed_sequence
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.pipelines.purpose import EVALUATION, Purpose, make_subject
from moseg.workflows.reports.panels import Panels


def evaluate(
    session: Session,
    dataset: str,
    sources: Sequence[SequenceSource],
    config: PipelineConfig,
    variants: Sequence[Variant],
    purpose: Purpose = EVALUATION,
    panels: Panels | None = None,
) -> AnyReport:
    """Score each variant on every sequence; equal nodes of the variants are computed once.

    The cues that all motion models start from are computed whatever the variants, so that an evaluation of other
    variants finds them.

    Parameters
    ----------
    purpose : Purpose
        What the run's log records about it.
    panels : Panels, optional
        Gather what a report shows, wave by wave; what they read is computed where it is missing.

    Raises
    ------
    InputError
        A sequence cannot be read, has no ground truth, or lacks a cue that `config` takes as given; or they have
        ground truth of several kinds.
    """
    over = find_ground_truth(sources)
    scores: dict[tuple[Variant, str], AnyScore] = {}
    for wave in in_waves(session, sources):
        scores |= _score(session, dataset, wave, over, config, variants, purpose, panels)
    by_variant = {v.value: {source.name: scores[v, source.name] for source in sources} for v in variants}
    return make_report(
        over,
        by_variant,
        dataset=dataset,
        store=session.use(),
        seconds=session.seconds,
        notes=purpose.notes,
    )


def _score(
    session: Session,
    dataset: str,
    sources: Sequence[SequenceSource],
    over: GroundTruth,
    config: PipelineConfig,
    variants: Sequence[Variant],
    purpose: Purpose,
    panels: Panels | None,
) -> dict[tuple[Variant, str], AnyScore]:
    """Return scores of the sequences of a wave, by variant and name."""
    refs: dict[tuple[Variant, str], str] = {}
    shown: dict[SequenceGraph, float | None] = {}
    recipes: dict[str, Recipe] = {}
    sinks_of: dict[str, list[str]] = {}

    def build():
        cues, sequences = [], []
        shown.clear()
        recipes.clear()
        sinks_of.clear()
        for source, leaves in zip(sources, ingest_sequences(session, sources, config, annotated=True), strict=True):
            graph = SequenceGraph(leaves, config)
            fps = source.frames.describe().fps
            sequences.append((leaves, fps))
            for variant in variants:
                refs[variant, leaves.name] = score = graph.score(variant)
                sinks_of.setdefault(leaves.name, []).append(score)
            cues.extend(graph.cues())
            sinks_of[leaves.name].extend(graph.cues())
            if panels is not None and panels.shows(leaves.name):
                shown[graph] = fps
                cues.extend(panels.sinks(graph))
            recipes.update(graph.recipes)
        session.log.describe(make_subject(purpose, dataset, config, variants, sequences))
        return recipes, (*refs.values(), *cues)

    def read():
        found = map_reads(session.store, session.store.attributes, refs.values())
        scores = {named: score_class(over)(**attributes) for named, attributes in zip(refs, found, strict=True)}
        for graph, fps in shown.items():
            panels.gather(session.store, graph, fps)
        return scores

    return session.compute(build, read, restated=name_failed_sequence(recipes, sinks_of))
