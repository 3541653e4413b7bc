"""Errors in the use of the command line, as one line that says how to go on."""

import os
import re
import shlex
from typing import Any

from typer.core import TyperGroup

from moseg.schemas.spelling import closest
from moseg.workflows.cli.help_texts import examples_of

_NO_SUCH_COMMAND = re.compile(r"No such command (?P<quote>['\"])(?P<name>.*?)(?P=quote)(?:\. Did you mean .*)?$")
_NOT_ONE_OF = re.compile(r"'([^']*)' is not one of (.*)$")


def describe_usage_error(error: Any) -> str:
    """Return the line for an error that `typer` found in a command line."""
    # The formatted message names the option; the plain one only says what is wrong with its value.
    message = " ".join(error.format_message().split()).rstrip(".").replace("Value error, ", "")
    message = message.replace("Input should be ", "expected ").partition(", unable to parse")[0]
    context = getattr(error, "ctx", None)
    kind = type(error).__name__
    if kind == "NoSuchOption":
        message = f"no such option {error.option_name!r}{_did_you_mean(error.option_name, _options(context))}"
    elif kind.startswith("Missing"):
        example = next(iter(examples_of(context.command)), None) if context else None
        message += f"; for example: {example}" if example else ""
    elif isinstance(getattr(context, "command", None), TyperGroup):
        message = _about_commands(message, context.command)
    choice = _NOT_ONE_OF.search(message)
    if choice is not None:
        message += _did_you_mean(choice[1], re.findall(r"'([^']*)'", choice[2]))
    path = context.command_path if context else "moseg"
    return f"{message[0].lower()}{message[1:]} (see {path} --help)"


def _about_commands(message: str, group: TyperGroup) -> str:
    named = _NO_SUCH_COMMAND.match(message)
    if named is None:
        return f"{message}: {', '.join(group.commands)}" if message == "Missing command" else message
    name = named["name"]
    close = closest(name, group.commands)
    if close is None and "segment" in group.commands and _may_be_a_video(name):
        return f"no such command {name!r}: did you mean `moseg segment {shlex.quote(name)}`?"
    hint = f": did you mean {close!r}?" if close else f"; one of {', '.join(group.commands)}"
    return f"no such command {name!r}{hint}"


def _may_be_a_video(text: str) -> bool:
    """Return whether a word is a path that exists, or has a place or a suffix as names of commands have not."""
    return os.path.exists(text) or any(character in text for character in "/.*")


def _options(context: Any) -> list[str]:
    return [name for parameter in context.command.params for name in parameter.opts] if context else []


def _did_you_mean(name: str, known: list[str]) -> str:
    close = closest(name, known)
    return "" if close is None else f": did you mean {close!r}?"
