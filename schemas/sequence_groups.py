"""Groups of the sequences of a benchmark, over which papers report their figures."""

from typing import NamedTuple


class SequenceGroup(NamedTuple):
    """A group that a sequence belongs to.

    Attributes
    ----------
    name : str
    place : int
        Of the group in the tables, from 0.
    num_published : int
        Sequences of the group in the published benchmark, of which some may not be on disk.
    """

    name: str
    place: int
    num_published: int
