"""The graph of a sequence: from a sink back to the decoded frames, every node a recipe."""

from workflows.graph.sequence_graph import SequenceGraph
from workflows.graph.sequence_leaves import GIVEN_SOURCES, SequenceLeaves

__all__ = ["GIVEN_SOURCES", "SequenceGraph", "SequenceLeaves"]
