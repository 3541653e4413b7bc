"""The console script: its commands, and how errors become one line and an exit code."""

import sys
import traceback

import typer
from typer.exceptions import TyperException
from typer.main import get_command

from schemas.errors import ClusterError, InputError, StoreError
from workflows.cli import contact_sheet, evaluate, inspect, score, segment, status
from workflows.cli.datasets import datasets_app
from workflows.cli.store import store_app
from workflows.cli.weights import weights_app

EXIT_FAULT, EXIT_BAD_INPUT, EXIT_INTERRUPTED = 1, 2, 130

app = typer.Typer(
    name="moseg",
    help="Zero-shot monocular motion segmentation: which pixels of a video move on their own.",
    pretty_exceptions_enable=False,
)
app.command("segment")(segment.segment)
app.command("eval")(evaluate.evaluate)
app.command("ablate")(evaluate.ablate)
app.command("plan")(evaluate.plan)
app.command("score")(score.score)
app.command("contact-sheet")(contact_sheet.contact_sheet)
app.command("status")(status.status)
app.command("backends")(inspect.backends)
app.add_typer(datasets_app, name="datasets")
app.add_typer(store_app, name="store")
app.add_typer(weights_app, name="weights")


def main(arguments: list[str] | None = None) -> None:
    """Run `moseg`: exit code 0 when done, 2 for bad use or input, 1 for a fault, 130 when interrupted."""
    sys.exit(run(sys.argv[1:] if arguments is None else arguments))


def run(arguments: list[str]) -> int:
    """The same, returning the exit code."""
    if not arguments:
        arguments = ["--help"]
    try:
        code = get_command(app)(arguments, standalone_mode=False) or 0
        # Typer turns an interruption into its exit code.
        if code == EXIT_INTERRUPTED:
            raise KeyboardInterrupt
        return code
    except TyperException as error:
        # The formatted message names the option; the plain one only says what is wrong with its value.
        message = " ".join(error.format_message().split()).rstrip(".")
        print(f"moseg: {message} (moseg --help lists commands, moseg COMMAND --help their options)", file=sys.stderr)
        return EXIT_BAD_INPUT
    except InputError as error:
        print(f"moseg: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except (StoreError, ClusterError) as error:
        print(f"moseg: {error}", file=sys.stderr)
        return EXIT_FAULT
    except KeyboardInterrupt:
        print("moseg: interrupted; what was finished is kept, the same command goes on from there", file=sys.stderr)
        return EXIT_INTERRUPTED
    except Exception as error:
        traceback.print_exc()
        print(f"moseg: a fault, not your input: {type(error).__name__}: {error}", file=sys.stderr)
        return EXIT_FAULT
