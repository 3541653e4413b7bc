"""Options that choose by name: what their help and their completion offer follows from the parameters there are.

It is looked up when the command line is built or a word is completed, so that choices of extensions are shown too.
"""

from collections.abc import Iterable
from typing import Any

import typer
from typer.core import TyperOption

from moseg.workflows.cli.completion import offer
from moseg.workflows.config.parameters import list_parameters
from moseg.workflows.config.pipeline_choices import PARAMETER_OF, SETS_OF

_OWN_VIDEO = ("segment", "view")
"""Commands for a user's own video, which has no ground truth."""
_OF_GROUND_TRUTH = ("gt", "groundtruth")


def named_option(option: str, help: str, metavar: str = "NAME") -> Any:
    """Declare an option; ``{choices}`` and ``{default}`` in its help are filled in by `fill_in_choices`."""
    return typer.Option(
        option,
        help=help,
        metavar=metavar,
        autocompletion=offer(lambda context: _complete(option, context.command.name)),
    )


def enumerate_names(names: Iterable[str]) -> str:
    """Return names as ``a, b or c``."""
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


def fill_in_choices(option: TyperOption, command: str | None) -> None:
    """Write the choices of a command and the default into the help of an option that is declared as `named_option`."""
    if option.help is None or "{choices}" not in option.help:
        return
    name = option.opts[0]
    choices = ["folder:PATH" if choice == "folder" else choice for choice in _choices(name, command)]
    # More may follow behind them: gt, auto or N.
    text = ", ".join(choices) if "{choices} or " in option.help else enumerate_names(choices)
    default = list_parameters()[PARAMETER_OF[name]].default if name in PARAMETER_OF else option.default
    option.help = option.help.format(choices=text, default=default)


def _choices(option: str, command: str | None) -> list[str]:
    names = SETS_OF[option] if option in SETS_OF else list_parameters()[PARAMETER_OF[option]].choices
    without = _OF_GROUND_TRUTH if command in _OWN_VIDEO else ()
    return [name for name in names if name not in without]


def _complete(option: str, command: str | None) -> list[str]:
    # What follows folder: is a path, which the shell itself would complete.
    return [f"{name}:" if name == "folder" else name for name in _choices(option, command)]
