"""Leaves of the graph of a clip of labelled trajectories."""

from typing import NamedTuple

from moseg.schemas.recipes import Ref
from moseg.schemas.sequence_groups import SequenceGroup


class TrajectoryLeaves(NamedTuple):
    """A clip after ingest.

    Attributes
    ----------
    name : str
    trajectories, labels : reference
    num_motions : int
        Number of labels that occur: the true number of motions, the background's included.
    groups : tuple of SequenceGroup
        Groups of the published benchmark that the clip belongs to.
    """

    name: str
    trajectories: Ref
    labels: Ref
    num_motions: int
    groups: tuple[SequenceGroup, ...] = ()
