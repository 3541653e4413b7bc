"""Where the graph of a clip of labelled trajectories ends."""

from typing import NamedTuple


class TrajectoryLeaves(NamedTuple):
    """A clip after ingest.

    Attributes
    ----------
    name : str
    trajectories, labels : reference
    num_motions : int
        Labels that occur: the true number of motions, the background's included.
    """

    name: str
    trajectories: str
    labels: str
    num_motions: int
