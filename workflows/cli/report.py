"""`moseg report`: one page about a run, with its pictures, matrices, tables and times."""

from pathlib import Path
from typing import Annotated

import typer

from moseg.workflows.cli.completion import complete_run
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption, StoreOption, sequence_names


def report(
    run: Annotated[
        str,
        typer.Argument(
            help="A run's name, the beginning of its name, or `latest`.", metavar="[RUN]", autocompletion=complete_run
        ),
    ] = "latest",
    out: Annotated[Path, typer.Option("--out", "-o", help="The page, a file of HTML.", metavar="FILE")] = Path(
        "report.html"
    ),
    sequences: Annotated[
        str | None,
        typer.Option("--sequences", help="Show these, separated by commas (default: the first 24).", metavar="NAMES"),
    ] = None,
    frames: Annotated[
        int, typer.Option("--frames", min=1, help="Frames of a sequence, spread over the annotated ones.", metavar="N")
    ] = 16,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Write one self-contained page about a run: overlays, motion cues, matrices, scores, times. Nothing is computed.

    Examples
    --------
    moseg report latest -o report.html
    """
    from moseg.store import open_store
    from moseg.workflows.exports import TextKind, check_replaceable
    from moseg.workflows.reports.from_log import report_run
    from moseg.workflows.reports.run_report import write_report

    check_replaceable(out, TextKind.PAGE)
    names = sequence_names(sequences)
    page = report_run(open_store(store, create=False), run, names, frames, quiet)
    print(write_report(out, page))
