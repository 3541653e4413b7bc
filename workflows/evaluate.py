"""Evaluation: variants of the pipeline scored on a data set."""

from collections.abc import Sequence

from schemas.configs import PipelineConfig, Variant
from schemas.scores import EvaluationReport, EvaluationRow, SequenceScore, mean_score
from workflows.datasets import SequenceSource, find_ground_truth
from workflows.graph import SequenceGraph
from workflows.leaves import ingest_sequences
from workflows.session import Session


def evaluate(
    session: Session,
    dataset: str,
    sources: Sequence[SequenceSource],
    config: PipelineConfig,
    variants: Sequence[Variant],
) -> EvaluationReport:
    """Score each variant on every sequence; equal nodes of the variants are computed once.

    The cues that all motion models start from are computed whatever the variants, so that an evaluation of other
    variants finds them.

    Raises
    ------
    InputError
        A sequence cannot be read, has no ground truth, or lacks a cue that `config` takes as given; or some have
        masks and others labelled points.
    """
    over = find_ground_truth(sources)
    scores: dict[tuple[Variant, str], str] = {}

    def build():
        recipes, cues = {}, []
        for leaves in ingest_sequences(session, sources, config, annotated=True):
            graph = SequenceGraph(leaves, config)
            for variant in variants:
                scores[variant, leaves.name] = graph.score(variant)
            cues.extend(graph.cues())
            recipes |= graph.recipes
        return recipes, (*scores.values(), *cues)

    def read():
        return {ref: SequenceScore(**session.store.attributes(ref)) for ref in scores.values()}

    by_ref = session.compute(build, read)
    rows = []
    for variant in variants:
        found = {source.name: by_ref[scores[variant, source.name]] for source in sources}
        rows.append(EvaluationRow(variant=variant.value, sequences=found, mean=mean_score(list(found.values()))))
    return EvaluationReport(dataset=dataset, over=over, rows=tuple(rows), store=session.use(), seconds=session.seconds)
