"""`moseg store ls` and `moseg store du`: what lies in the store, and what takes the room."""

from datetime import UTC, datetime
from typing import Annotated

import typer

from workflows.cli.options import DEFAULT_STORE, StoreOption
from workflows.cli.store_commands.finding import open_existing
from workflows.cli.store_commands.writing import size


def list_artifacts(
    task: Annotated[str | None, typer.Option("--task", help="Only this task's artifacts.")] = None,
    runs: Annotated[bool, typer.Option("--runs", help="List the runs whose artifacts gc keeps instead.")] = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """List artifacts, or the runs that keep them. Example: moseg store ls --task flow"""
    opened = open_existing(store)
    if runs:
        for run_id, pin in sorted(opened.pinned().items(), key=lambda item: item[1].created):
            created = datetime.fromtimestamp(pin.created, UTC).isoformat(timespec="seconds")
            state = "finished" if pin.expires is None else "running"
            print(f"{run_id}  {created}  {state}  {len(pin.refs)} references")
        return
    for ref in opened.refs(task):
        print(ref)


def disk_use(store: StoreOption = DEFAULT_STORE) -> None:
    """Artifacts and bytes by task."""
    print_use(open_existing(store).usage())


def print_use(usage) -> None:
    """A table of artifacts and bytes by task, the largest first, and their sum."""
    rows = [(nbytes, count, task) for task, (count, nbytes) in usage.items()]
    rows.sort(reverse=True)
    rows.append((sum(row[0] for row in rows), sum(row[1] for row in rows), "total"))
    for nbytes, count, task in rows:
        print(f"{size(nbytes):>10}  {count:>7}  {task}")
