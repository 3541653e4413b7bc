"""`moseg store verify` and `moseg store gc`: whether the store is sound, and how to make room."""

from collections.abc import Iterator
from typing import Annotated

import typer

from moseg.schemas.errors import MissingArtifactError
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption, StoreOption
from moseg.workflows.cli.store_commands.finding import find_pins, open_existing
from moseg.workflows.cli.store_commands.listing import size
from moseg.workflows.process.progress import StageProgress, Waiting


def verify(
    quarantine: Annotated[bool, typer.Option("--quarantine", help="Take bad artifacts out of service.")] = False,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Compare every artifact's bytes with its manifest; exit code 1 where one is bad.

    Examples
    --------
    moseg store verify
    moseg store verify --quarantine
    """
    opened = open_existing(store)
    count, bad = 0, []
    refs = list(opened.refs())
    try:
        with StageProgress({"verified": len(refs)}, quiet) as progress:
            for result in _check_all(opened, refs):
                count += 1
                if not result.is_intact:
                    bad.append(result)
                    if quarantine:
                        opened.quarantine(result.ref, result.problem)
                progress.advance("verified")
    finally:
        # After the bar, which would carry them along to standard error; also those found before an interruption.
        for result in bad:
            print(f"{result.ref}: {result.problem}")
    print(f"{count} artifacts, {len(bad)} bad{' (quarantined)' if quarantine and bad else ''}")
    if bad:
        raise typer.Exit(1)


def collect(
    delete: Annotated[
        bool, typer.Option("--delete", help="Delete; without it, only show what would be deleted.")
    ] = False,
    grace_hours: Annotated[float, typer.Option("--grace-hours", min=0, help="Spare what is younger.")] = 24.0,
    forget: Annotated[
        list[str] | None, typer.Option("--forget", help="Runs no longer to keep; see ls --runs.", metavar="RUN")
    ] = None,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Collect artifacts that no kept run reaches, and the logs of ended runs that are not kept.

    Examples
    --------
    moseg store gc
    moseg store gc --delete --grace-hours 1
    moseg store gc --forget 1a2b… --delete
    """
    from moseg.workflows.runlog.status import old_logs

    opened = open_existing(store)
    forgotten = {name for run in forget or [] for name in find_pins(opened, run)}
    if delete:
        for name in forgotten:
            opened.unpin(name)
    grace_seconds = grace_hours * 3600
    with Waiting("looking for what no kept run reaches", quiet):
        report = opened.gc(is_dry=not delete, grace_seconds=grace_seconds)
        logs = old_logs(opened, grace_seconds)
        if delete:
            for run_id in logs:
                opened.remove_log(run_id)
    for ref in report.removed:
        print(ref)
    verb = "removed" if delete else "would be removed (--delete does it)"
    print(
        f"{len(report.removed)} artifacts, {len(report.leftovers)} leftovers and the logs of {len(logs)} ended runs"
        f" {verb}: {size(report.nbytes)}; {report.num_kept} artifacts stay"
    )
    if forget and not delete:
        print("--forget takes effect with --delete only: the artifacts of these runs are counted as staying")


def _check_all(store, refs: list[str]) -> Iterator:
    """Yield what `verify` finds of each artifact, several at a time over a network; those that vanish are skipped."""
    from moseg.store.ahead import map_reads

    def check(ref: str):
        try:
            return list(store.verify([ref]))
        except MissingArtifactError:
            return []

    for results in map_reads(store, check, refs):
        yield from results
