"""The console script: its commands, and how errors become one line and an exit code."""

import errno
import sys
import traceback
from functools import cache
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException
from typer.main import get_command

from moseg.schemas.errors import ClusterError, InputError, StoreError
from moseg.workflows.cli import backends, contact_sheet, evaluate, export, report, segment, status, train, view
from moseg.workflows.cli.config import config_app
from moseg.workflows.cli.datasets import datasets_app
from moseg.workflows.cli.entry import EXIT_FAULT, EXIT_INTERRUPTED, report_interruption
from moseg.workflows.cli.help_texts import HELP_NAMES, with_readable_help
from moseg.workflows.cli.store import store_app
from moseg.workflows.cli.usage_errors import describe_usage_error
from moseg.workflows.cli.weights import weights_app
from moseg.workflows.plugins.failing import failing_plugin
from moseg.workflows.plugins.loading import load_plugins

EXIT_BAD_INPUT = 2
FULL = (errno.ENOSPC, errno.EDQUOT)
"""Errors of a full disk other than the store's: standard output may lead to one."""

app = typer.Typer(
    name="moseg", pretty_exceptions_enable=False, context_settings={"help_option_names": list(HELP_NAMES)}
)
app.command("segment")(segment.segment)
app.command("view")(view.view)
app.command("export")(export.export)
app.command("eval")(evaluate.evaluate)
app.command("ablate")(evaluate.ablate)
app.command("plan")(evaluate.plan)
app.command("score")(evaluate.score)
app.command("contact-sheet")(contact_sheet.contact_sheet)
app.command("report")(report.report)
app.command("status")(status.status)
app.command("train")(train.train)
app.command("backends")(backends.backends)
app.add_typer(config_app, name="config")
app.add_typer(datasets_app, name="datasets")
app.add_typer(store_app, name="store")
app.add_typer(weights_app, name="weights")


def _print_version(is_asked: bool) -> None:
    if is_asked:
        from importlib.metadata import version

        print(f"moseg {version('moseg')}")
        raise typer.Exit


@app.callback()
def moseg(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", is_eager=True, callback=_print_version)
    ] = False,
) -> None:
    """Zero-shot monocular motion segmentation: which pixels of a video move on their own.

    Examples
    --------
    moseg segment holiday.mp4 --out holiday
    moseg eval --dataset synthetic
    moseg eval --help
    """


@cache
def build_command() -> Any:
    """Return the command line as it is parsed; it is built once, because reading all signatures takes a while."""
    return with_readable_help(get_command(app))


def run(arguments: list[str]) -> int:
    """Run `moseg` and return its exit code: 0 done, 2 bad use or input, 1 a fault, 130 or 143 interrupted."""
    try:
        load_plugins()
        command = build_command()
        code = command(arguments or ["--help"], prog_name="moseg", standalone_mode=False) or 0
        # Typer turns an interruption into its exit code.
        if code == EXIT_INTERRUPTED:
            raise KeyboardInterrupt
        return code
    except TyperException as error:
        print(f"moseg: {describe_usage_error(error)}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except InputError as error:
        print(f"moseg: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except (StoreError, ClusterError) as error:
        print(f"moseg: {error}", file=sys.stderr)
        return EXIT_FAULT
    except KeyboardInterrupt:
        return report_interruption()
    except Exception as error:
        if isinstance(error, OSError) and error.errno in FULL:
            print(f"moseg: nothing more can be written: {error.strerror}", file=sys.stderr)
            return EXIT_FAULT
        traceback.print_exc()
        plugin = failing_plugin(error)
        place = "a fault, not your input" if plugin is None else f"a fault in plug-in {plugin}"
        # Messages of libraries may have several lines.
        print(f"moseg: {place}: {type(error).__name__}: {' '.join(str(error).split())}", file=sys.stderr)
        return EXIT_FAULT
