"""`moseg datasets`: which data sets are there, which are missing, and how to get them."""

import os
from typing import Annotated

import typer

from moseg.workflows.cli.completion import complete_dataset

datasets_app = typer.Typer()


@datasets_app.callback(invoke_without_command=True)
def datasets(context: typer.Context) -> None:
    """List data sets: which are there, which are missing, and how to get them.

    Examples
    --------
    moseg datasets
    moseg datasets show davis16
    """
    from moseg.workflows.datasets import describe_datasets

    if context.invoked_subcommand is not None:
        return
    for row in describe_datasets(os.environ):
        _print_row(row)
        if row.is_present and row.absent:
            print(f"    absent        {', '.join(row.absent)}")
    print("A data set is looked for at --root, else at $MOSEG_DATA/<name>.")


@datasets_app.command("show")
def show(
    name: Annotated[str, typer.Argument(help="Name of the data set.", metavar="NAME", autocompletion=complete_dataset)],
    root: Annotated[str | None, typer.Option("--root", help="Its folder (default: $MOSEG_DATA/<name>).")] = None,
) -> None:
    """Show one data set: ground truth, layouts on disk, and its sequences.

    Examples
    --------
    moseg datasets show kt3dinsmoseg
    moseg datasets show davis16 --root DAVIS
    """
    from moseg.workflows.datasets import describe_dataset

    row = describe_dataset(name, root, os.environ)
    _print_row(row)
    print(f"    here          {', '.join(row.names) or 'none'}")
    print(f"    absent        {', '.join(row.absent) or 'none'}")


def _print_row(row) -> None:
    """Print a data set's lines, with a line for each of several layouts."""
    found = f"{len(row.names)} sequences" if row.is_present else f"not here: {row.problem}"
    print(f"{row.name}: {found}")
    for title, text in (("ground truth", row.ground_truth), ("files", row.tree), ("from", row.source)):
        first, *others = text.split("; or ")
        print(f"    {title:<14}{first}")
        for other in others:
            print(f"    {'or':>12}  {other}")
