"""The graph of a sequence, or of a clip of trajectories: recipes, from a sink back to the decoded leaves."""

from moseg.workflows.graph.repetitions import Repetitions
from moseg.workflows.graph.scenes_graph import make_graph
from moseg.workflows.graph.sequence_graph import SequenceGraph
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES, SequenceLeaves
from moseg.workflows.graph.slow_motion import SlowMotionGaps
from moseg.workflows.graph.stretches import Stretches
from moseg.workflows.graph.trajectory_graph import TrajectoryGraph
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves

__all__ = [
    "GIVEN_SOURCES",
    "Repetitions",
    "SequenceGraph",
    "SequenceLeaves",
    "SlowMotionGaps",
    "Stretches",
    "TrajectoryGraph",
    "TrajectoryLeaves",
    "make_graph",
]
