"""Readable help: docstrings as paragraphs for any width, and their examples below the options."""

import inspect
import re
from typing import Any

import typer
from rich.markup import escape
from typer.core import TyperCommand, TyperGroup, TyperOption

from moseg.workflows.cli.export import fill_in_formats
from moseg.workflows.cli.named_options import fill_in_choices

HELP_NAMES = ("-h", "--help")
"""Options that show the help of a command."""

_EXAMPLES = re.compile(r"\n*^Examples\n-+\n(.*)\Z", re.MULTILINE | re.DOTALL)

_KIND = re.compile(r"<(?:list\[)?(int|float|str)\b")


def with_readable_help(command: Any) -> Any:
    """Return a command, or a group with all its commands, of `typer` with its help and that of its options tidied."""
    if isinstance(command, TyperGroup | TyperCommand):
        _tidy(command)
    for inner in getattr(command, "commands", {}).values():
        with_readable_help(inner)
    return command


def examples_of(command: Any) -> list[str]:
    """Return the command lines that a command's help shows."""
    return (command.epilog or "").splitlines()[1:]


def _tidy(command: TyperGroup | TyperCommand) -> None:
    text = inspect.cleandoc(command.help or "")
    examples = _EXAMPLES.search(text)
    if examples is not None:
        text = text[: examples.start()]
        lines = [line.strip() for line in examples[1].splitlines() if line.strip()]
        command.epilog = "\n".join(["[bold]Examples:[/bold]", *map(escape, lines)])
    # The lines of a docstring may be longer than a terminal's: joined, they are broken only once.
    command.help = "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))
    context = typer.Context(command, help_option_names=list(HELP_NAMES))
    for parameter in (*command.params, command.get_help_option(context)):
        if isinstance(parameter, TyperOption):
            fill_in_choices(parameter, command.name)
            fill_in_formats(parameter)
        if isinstance(parameter, TyperOption) and (parameter.is_flag or parameter.is_eager):
            parameter.metavar = ""
        elif isinstance(parameter, TyperOption) and parameter.metavar is None:
            kind = _KIND.search(parameter.display_type(context))
            parameter.metavar = None if kind is None else "N" if kind[1] in ("int", "float") else "TEXT"
