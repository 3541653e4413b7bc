"""`moseg store verify` and `moseg store gc`: whether the store is sound, and how to make room."""

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from moseg.schemas.errors import InputError, MissingArtifactError
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption, StoreOption
from moseg.workflows.cli.store_commands.finding import find_pins, open_existing
from moseg.workflows.process.amounts import read_age, read_size, size
from moseg.workflows.process.progress import StageProgress, Waiting

if TYPE_CHECKING:
    from moseg.store import Pin


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
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would be deleted (the default).")] = False,
    older: Annotated[
        str | None,
        typer.Option("--older", help="No longer keep runs last used longer ago (12h, 7d, 2w).", metavar="AGE"),
    ] = None,
    keep_size: Annotated[
        str | None,
        typer.Option(
            "--keep-size",
            help="Only until the store is this small (500M, 20G), the least recently used first.",
            metavar="SIZE",
        ),
    ] = None,
    forget: Annotated[
        list[str] | None,
        typer.Option("--forget", help="Runs no longer to keep; see status or ls --runs.", metavar="RUN"),
    ] = None,
    grace_hours: Annotated[float, typer.Option("--grace-hours", min=0, help="Spare what is younger.")] = 24.0,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Collect artifacts that no kept run reaches, and the logs of ended runs that are not kept.

    Nothing is deleted without --delete: the same command without it is an exact preview.

    Examples
    --------
    moseg store gc
    moseg store gc --older 7d --keep-size 20G --dry-run
    moseg store gc --older 7d --delete
    moseg store gc --forget latest --delete
    """
    from moseg.workflows.runlog.status import old_logs

    if delete and dry_run:
        raise InputError("deletes and only shows", where="--delete", got="--dry-run", expected="one of them")
    grace_seconds = grace_hours * 3600
    age = None if older is None else read_age(older, "--older")
    keep_nbytes = None if keep_size is None else read_size(keep_size, "--keep-size")
    opened = open_existing(store)
    forgotten = {name for run in forget or [] for name in find_pins(opened, run)}
    if age is not None:
        forgotten |= {name for name, pin in opened.pinned().items() if _is_older(pin, age)}
    with Waiting("looking for what no kept run reaches", quiet):
        logs = old_logs(opened, grace_seconds, forgotten)
        report = opened.gc(is_dry=not delete, grace_seconds=grace_seconds, forget=forgotten, keep_nbytes=keep_nbytes)
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
    if forgotten:
        print(f"{len(forgotten)} pins of runs {'removed' if delete else 'would be removed'}")
    if report.left is not None and report.left > keep_nbytes:
        print(
            f"{size(report.left)} stay, more than {size(keep_nbytes)}: younger than --grace-hours, or kept by runs (see"
            " ls --runs) until --older or --forget"
        )


def _is_older(pin: "Pin", age: float) -> bool:
    """Return whether a finished run was last used longer ago than this age, s."""
    return pin.expires is None and pin.created < time.time() - age


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
