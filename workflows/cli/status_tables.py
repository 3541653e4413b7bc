"""A run's status, and a list of runs, on the terminal."""

import shlex
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime

from rich import box
from rich.console import Group, RenderableType
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from moseg.workflows.runlog.choices import describe_choices
from moseg.workflows.runlog.status import RunState, RunStatus
from moseg.workflows.runlog.status_counts import StageStatus, Trouble

COLOURS = {
    RunState.RUNNING: "cyan",
    RunState.FINISHED: "green",
    RunState.FAILED: "red",
    RunState.INTERRUPTED: "yellow",
    RunState.DEAD: "red",
}
BAR_WIDTH = 20
NUM_SLOWEST = 3
NUM_TOLD = 10
"""Failures that are printed in full; all of them stand in the JSON."""
KEY_DIGITS = 10
"""Digits of a key that are printed: `moseg store show` takes them, and no two keys of a store begin alike."""


def status_view(status: RunStatus) -> RenderableType:
    """Return the head of a run, its stages and its problems."""
    parts: list[RenderableType] = [*_head(status)]
    if status.stages:
        parts.append(_stage_table(status.stages))
    if status.choices:
        parts.append(_line("proposals", describe_choices(status.choices)))
    parts += _in_flight(status)
    parts += _slowest(status.stages)
    parts += _degenerate(status.stages)
    parts += _troubles("quarantined and planned anew", status.quarantined)
    parts += _troubles("failed", status.failures)
    if status.message is not None and status.message not in [trouble.message for trouble in status.failures]:
        parts.append(_line("ended by", status.message))
    if status.num_unreadable:
        lines = f"{status.num_unreadable} line{'' if status.num_unreadable == 1 else 's'} of the log"
        parts.append(_line("unreadable", f"{lines}, cut short or of another version; the counts lack them", "red"))
    if status.pins:
        parts.append(_line("results kept by pin", ", ".join(status.pins)))
    return Group(*parts)


def runs_view(runs: Sequence[RunStatus]) -> RenderableType:
    """Return two lines a run, which fit a narrow terminal: its state, and when and by which command it began."""
    width = max(len(run.run_id) for run in runs)
    lines = [Text(f"{'run':<{width}}  {'state':<11}  {'done':>13}  {'failed':>6}  last event", style="bold")]
    for run in runs:
        done, silent = f"{run.num_done}/{run.num_planned}", _duration((run.asked - run.last_event).total_seconds())
        failed = (f"{_count(run.num_failed):>6}", "red")
        state = (f"{_state(run).plain:<11}", COLOURS[run.state])
        lines.append(Text.assemble(f"{run.run_id:<{width}}  ", state, f"  {done:>13}  ", failed, f"  {silent} ago"))
        command = Text(f"  {_moment(run.started)} UTC  {shlex.join(run.command)}", style="dim")
        lines.append(Text.assemble(command, no_wrap=True, overflow="ellipsis"))
    return Group(*lines)


def _head(status: RunStatus) -> Iterator[Text]:
    share = f" ({100 * status.num_done / status.num_planned:.0f} %)" if status.num_planned else ""
    facts = [f"{status.num_done} of {status.num_planned} artifacts{share}", _duration(status.seconds)]
    if status.rest_seconds is not None:
        facts.append(f"about {_duration(status.rest_seconds)} left")
    if status.state == RunState.DEAD:
        facts.append(f"process {status.pid} is gone; the same command goes on from here")
    if not status.is_asked:
        silent = _duration((status.asked - status.last_event).total_seconds())
        facts.append(f"last heard of {silent} ago: its host {status.host} cannot be asked from here")
    yield Text.assemble(("run ", ""), (status.run_id, "bold"), "  ", _state(status), "  ", ", ".join(facts))
    yield Text(shlex.join(status.command), style="dim")
    workers = f"{status.num_workers} worker{'' if status.num_workers == 1 else 's'}"
    place = f"by process {status.pid} of {status.host} in {status.folder}"
    yield Text(f"started {_moment(status.started)} UTC {place}, {workers}, moseg {status.version}", style="dim")


def _stage_table(stages: Sequence[StageStatus]) -> Table:
    """Return stages as rows; a column of counts is shown where one of them is not 0."""
    columns = {
        "done": [f"{stage.done}/{stage.planned}" if stage.planned else "" for stage in stages],
        "reused": [_count(stage.hits) for stage in stages],
        "lost races": [_count(stage.lost_races) for stage in stages],
        "degenerate": [_count(stage.degenerate) for stage in stages],
        "failed": [_count(stage.failed) for stage in stages],
        "seconds": [f"{stage.seconds:.1f}" if stage.computed else "" for stage in stages],
        "each": [f"{stage.seconds / stage.computed:.3f}" if stage.computed else "" for stage in stages],
    }
    columns = {name: cells for name, cells in columns.items() if any(cells)}
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("stage")
    table.add_column("")
    for name in columns:
        table.add_column(name, justify="right", style="red" if name == "failed" else None)
    for stage, *cells in zip(stages, *columns.values(), strict=True):
        bar = ProgressBar(stage.planned, stage.done, width=BAR_WIDTH, finished_style="green")
        table.add_row(stage.stage, bar if stage.planned else "", *cells)
    return table


def _count(number: int) -> str:
    return str(number or "")


def _in_flight(status: RunStatus) -> Iterator[Text]:
    is_running = status.state == RunState.RUNNING
    for work in status.in_flight:
        seconds = max((status.asked - work.since).total_seconds(), 0.0)
        since = f" for {_duration(seconds)}" if is_running else ""
        behind = f", {work.num_behind} more behind it" if work.num_behind else ""
        text = f"{_short(work.ref)}{since}{behind} (process {work.pid} of {work.host})"
        yield _line("in flight" if is_running else "was in flight", text)


def _slowest(stages: Sequence[StageStatus]) -> Iterator[Text]:
    total = sum(stage.seconds for stage in stages)
    if total > 0:
        slowest = sorted(stages, key=lambda stage: -stage.seconds)[:NUM_SLOWEST]
        shares = (f"{stage.stage} {stage.seconds:.1f} s ({100 * stage.seconds / total:.0f} %)" for stage in slowest)
        yield _line("slowest", ", ".join(shares))


def _degenerate(stages: Sequence[StageStatus]) -> Iterator[Text]:
    for stage in stages:
        if stage.degenerate:
            reasons = ", ".join(f"{name} {count}" for name, count in sorted(stage.reasons.items()))
            text = f"{stage.stage}: {stage.invalid_fits} of {stage.fits} fits in {_artifacts(stage.degenerate)}"
            yield _line("degenerate", f"{text}{f': {reasons}' if reasons else ''}")


def _troubles(what: str, troubles: Sequence[Trouble]) -> Iterator[Text]:
    for trouble in troubles[:NUM_TOLD]:
        about = f"{_short(trouble.ref)}: " if trouble.ref is not None else ""
        yield _line(what, f"{about}{trouble.message}", style="red")
    if len(troubles) > NUM_TOLD:
        yield _line(what, f"and {len(troubles) - NUM_TOLD} more (--json FILE has them all)", style="red")


def _line(what: str, text: str, style: str = "bold") -> Text:
    return Text.assemble((f"{what}: ", style), text)


def _state(status: RunStatus) -> Text:
    return Text(status.state if status.is_asked else f"{status.state}?", style=COLOURS[status.state])


def _artifacts(count: int) -> str:
    return f"{count} artifact{'' if count == 1 else 's'}"


def _short(ref: str) -> str:
    stage, _, key = ref.partition("/")
    return f"{stage}/{key[:KEY_DIGITS]}"


def _moment(moment: datetime) -> str:
    return f"{moment.astimezone(UTC):%Y-%m-%d %H:%M:%S}"


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    days, hours = divmod(hours, 24)
    if days:
        return f"{days} d {hours} h"
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {seconds:02d} s"
