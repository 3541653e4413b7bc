"""What a report shows as tables: scores, objects, stages, parameters."""

from enum import StrEnum
from typing import NamedTuple

from moseg.schemas.scores import GroundTruth


class Better(StrEnum):
    """Which of two figures is the better one."""

    MORE = "more"
    LESS = "less"


class ScoreTable(NamedTuple):
    """Scores: a head and rows of a name and percentages; None is an empty cell.

    Attributes
    ----------
    title : str
    columns : tuple of str
        The first one names the rows.
    rows : tuple of (str, tuple of float or None)
    is_published : bool
        Whether these are figures that a paper reports, which nobody measured here.
    over : 'pixels', 'points' or None
    better : tuple of Better or None
        For each figure's column which values are better, None where neither is (a count); empty: more, in all of them.
    decimals : tuple of int
        Digits behind the point in each figure's column; empty: one in all of them.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[float | None, ...]], ...]
    is_published: bool = False
    over: GroundTruth | None = None
    better: tuple[Better | None, ...] = ()
    decimals: tuple[int, ...] = ()


class ObjectRow(NamedTuple):
    """One moving object: its colour in the overlay (``#rrggbb``), when it is seen and how large it is."""

    identity: int
    colour: str
    motion: int
    first_frame: int
    last_frame: int
    num_frames: int
    mean_area_percent: float
    tag: str | None = None


class StageRow(NamedTuple):
    """Artifacts of one stage that the run computed and reused, and the seconds inside the stage's functions."""

    stage: str
    computed: int
    reused: int
    seconds: float


class ParameterRow(NamedTuple):
    """A parameter that differs from its default; texts as a user writes them."""

    name: str
    value: str
    default: str
    description: str
