"""`moseg store ls` and `moseg store du`: what lies in the store, and what takes the room."""

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated

import typer

from moseg.schemas.spelling import closest, unknown_name
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption, StoreOption
from moseg.workflows.cli.store_commands.finding import open_existing
from moseg.workflows.process.amounts import size
from moseg.workflows.process.progress import Waiting

if TYPE_CHECKING:
    from moseg.store import Pin


def list_artifacts(
    task: Annotated[str | None, typer.Option("--task", help="Only this task's artifacts.")] = None,
    runs: Annotated[bool, typer.Option("--runs", help="List the runs whose artifacts gc keeps instead.")] = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """List artifacts, or the runs that keep them.

    Examples
    --------
    moseg store ls
    moseg store ls --task flow
    moseg store ls --runs
    """

    opened = open_existing(store)
    if runs:
        for line in _list_runs(opened.pinned()):
            print(line)
        return
    ref = None
    for ref in opened.refs(task):
        print(ref)
    # A known task without artifacts is no error, and neither is an unknown one, unless its name is nearly a known one.
    from moseg.workflows.stages.registry import artifact_names

    names = artifact_names()
    if ref is None and task is not None and task not in names and closest(task, names) is not None:
        raise unknown_name("task", task, names, where="--task")


def _list_runs(pinned: "Mapping[str, Pin]") -> Iterator[str]:
    """Yield a line for each run that has pins, with the time at which it was last used."""
    runs: dict[str, list[Pin]] = {}
    for name, pin in sorted(pinned.items(), key=lambda item: item[1].created):
        runs.setdefault(pin.run or name, []).append(pin)
    for name, pins in runs.items():
        used = datetime.fromtimestamp(max(pin.created for pin in pins), UTC).isoformat(timespec="seconds")
        state = "finished" if all(pin.expires is None for pin in pins) else "running"
        yield f"{name}  {used}  {state}  {sum(len(pin.refs) for pin in pins)} references"


def disk_use(quiet: QuietOption = False, store: StoreOption = DEFAULT_STORE) -> None:
    """Show artifacts and bytes by task.

    Examples
    --------
    moseg store du
    moseg store du --store s3://bucket/moseg
    """
    opened = open_existing(store)
    with Waiting("adding up the store", quiet):
        usage = opened.usage()
    print_use(usage)


def print_use(usage) -> None:
    """Print a table of artifacts and bytes by task, the largest first, and their sum."""
    rows = [(nbytes, count, task) for task, (count, nbytes) in usage.items()]
    rows.sort(reverse=True)
    rows.append((sum(row[0] for row in rows), sum(row[1] for row in rows), "total"))
    for nbytes, count, task in rows:
        print(f"{size(nbytes):>10}  {count:>7}  {task}")
