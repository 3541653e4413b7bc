"""Frames that repeat the one before them, found before the rest of the graph is written.

The graph reads motion between frames that differ, so that it cannot be written before they are known.
"""

from collections.abc import Mapping, Sequence

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import Repetitions, SequenceLeaves
from moseg.workflows.pipelines.settled import settle_attributes


def settle_repetitions(
    session: Session, leaves: Sequence[SequenceLeaves], config: PipelineConfig
) -> list[SequenceLeaves]:
    """Return the leaves with the frames that repeat others, which are looked for where that is not known."""
    writers = repetition_writers(leaves, config)
    return with_repetitions(leaves, writers, settle_attributes(session, leaves, writers))


def repetition_writers(leaves: Sequence[SequenceLeaves], config: PipelineConfig) -> list[Repetitions]:
    """Return the writers of the recipes of each sequence's repetitions."""
    return [Repetitions(each, config) for each in leaves]


def with_repetitions(
    leaves: Sequence[SequenceLeaves], writers: Sequence[Repetitions], attributes: Mapping[str, Mapping]
) -> list[SequenceLeaves]:
    """Return the leaves with the repetitions whose attributes are known, by reference."""
    found = []
    for each, writer in zip(leaves, writers, strict=True):
        rows = [attributes.get(ref, {}).get("repetitions", ()) for ref in writer.refs()]
        found.append(each._replace(repetitions=writer.frames(rows)))
    return found
