"""Time and reuse of each stage, as bars."""

from typing import NamedTuple

from moseg.workflows.reports.page.numbers import duration
from moseg.workflows.reports.table_content import StageRow


class StageBar(NamedTuple):
    """A stage, its time as text (a dash where none was spent), and the length of its bar in percent of the longest."""

    row: StageRow
    time: str
    percent: float


class Stages(NamedTuple):
    """Every stage of a run and their sums; the share reused in percent, the time as text."""

    bars: tuple[StageBar, ...]
    computed: int
    reused: int
    percent_reused: float
    time: str


def _time(seconds: float) -> str:
    return duration(seconds) if seconds else "–"


def gather_stages(rows: tuple[StageRow, ...]) -> Stages:
    """What a page shows of the stages of a run, in their order."""
    longest = max((row.seconds for row in rows), default=0.0) or 1.0
    computed, reused = sum(row.computed for row in rows), sum(row.reused for row in rows)
    return Stages(
        bars=tuple(StageBar(row, _time(row.seconds), round(100 * row.seconds / longest, 2)) for row in rows),
        computed=computed,
        reused=reused,
        percent_reused=round(100 * reused / max(1, computed + reused), 1),
        time=_time(sum(row.seconds for row in rows)),
    )
