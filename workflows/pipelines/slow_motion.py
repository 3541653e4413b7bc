"""Distances of the pictures between which motion is seen, settled before the rest of the graph is written."""

from collections.abc import Mapping, Sequence

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceLeaves, SlowMotionGaps
from moseg.workflows.pipelines.settled import settle_attributes


def settle_gaps(session: Session, leaves: Sequence[SequenceLeaves], config: PipelineConfig) -> list[SequenceLeaves]:
    """Return the leaves with the distances of pictures, which are chosen where that is not known."""
    writers = gap_writers(leaves, config)
    return with_gaps(leaves, writers, settle_attributes(session, leaves, writers))


def gap_writers(leaves: Sequence[SequenceLeaves], config: PipelineConfig) -> list[SlowMotionGaps]:
    """Return the writers of the recipes of each sequence's distances."""
    return [SlowMotionGaps(each, config) for each in leaves]


def with_gaps(
    leaves: Sequence[SequenceLeaves], writers: Sequence[SlowMotionGaps], attributes: Mapping[str, Mapping]
) -> list[SequenceLeaves]:
    """Return the leaves with the distances whose attributes are known, by reference; others are 1."""
    found = []
    for each, writer in zip(leaves, writers, strict=True):
        gaps = [attributes.get(ref, {}).get("gap", 1) for ref in writer.refs()]
        found.append(each._replace(gaps=writer.gaps(gaps)))
    return found
