"""`moseg status`: how a run goes, or went, and which runs there were."""

import time
from pathlib import Path
from typing import Annotated

import typer

from moseg.workflows.cli.completion import complete_run
from moseg.workflows.cli.options import DEFAULT_STORE, JsonOption, StoreOption

REFRESH_SECONDS = 1.0
READING_SHARE = 0.1
"""Part of the time that following a run may spend reading its log, which grows with the run."""


def status(
    run: Annotated[
        str | None,
        typer.Argument(
            help="A run's name, the beginning of its name, or `latest`. Without it: a list of the last runs.",
            metavar="[RUN]",
            autocompletion=complete_run,
        ),
    ] = None,
    follow: Annotated[
        bool, typer.Option("--follow", help="Refresh until the run (by default the latest) ends.")
    ] = False,
    last: Annotated[int, typer.Option("--last", min=1, help="How many runs to list.")] = 20,
    json: JsonOption = None,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Show the progress of a run by stage, what is in flight and what failed, while it runs and after.

    Examples
    --------
    moseg status
    moseg status latest --follow
    moseg status latest --json run.json
    """
    from moseg.store import open_store
    from moseg.workflows.exports import TextKind, check_replaceable, write_text
    from moseg.workflows.runlog.status import LATEST, find_run, list_runs

    if json is not None:
        check_replaceable(Path(json), TextKind.JSON)
    opened = open_store(store, create=False)
    if run is None and not follow:
        runs = list_runs(opened)
        text = _print_runs(opened, runs[:last], num_earlier=max(len(runs) - last, 0))
    else:
        text = _show(opened, find_run(opened, LATEST if run is None else run), follow)
    if json is not None:
        write_text(Path(json), text + "\n")


def _print_runs(store, run_ids: list[str], num_earlier: int) -> str:
    """Print a list of runs, those whose logs cannot be read last; the others' statuses as JSON."""
    from pydantic import TypeAdapter

    from moseg.schemas.errors import StoreError
    from moseg.workflows.cli.status_tables import runs_view
    from moseg.workflows.cli.tables import console
    from moseg.workflows.runlog.status import RunStatus, read_status

    runs, unreadable = [], []
    for run_id in run_ids:
        try:
            runs.append(read_status(store, run_id))
        except StoreError as error:
            unreadable.append(f"{run_id}  unreadable: {error}")
    if not run_ids:
        print(f"no run has computed anything in {store.url}, or their logs were collected")
    if runs:
        console().print(runs_view(runs))
    for line in unreadable:
        print(line)
    if num_earlier:
        print(f"and {num_earlier} earlier (--last N lists more)")
    return TypeAdapter(list[RunStatus]).dump_json(runs, indent=2).decode()


def _show(store, run_id: str, follow: bool) -> str:
    """Print a run's status, or show it until the run ends; the last one as JSON."""
    from rich.live import Live

    from moseg.workflows.cli.status_tables import status_view
    from moseg.workflows.cli.tables import console
    from moseg.workflows.runlog.status import RunState, read_status

    found = read_status(store, run_id)
    if not follow:
        console().print(status_view(found))
        return found.model_dump_json(indent=2)
    with Live(status_view(found), console=console(), auto_refresh=False) as live:
        try:
            while found.state == RunState.RUNNING:
                began = time.monotonic()
                found = read_status(store, run_id)
                live.update(status_view(found), refresh=True)
                if found.state == RunState.RUNNING:
                    time.sleep(max(REFRESH_SECONDS, (time.monotonic() - began) / READING_SHARE))
        except KeyboardInterrupt:
            # Whoever stops looking has interrupted nothing: the run goes on.
            live.update(status_view(found), refresh=True)
    return found.model_dump_json(indent=2)
