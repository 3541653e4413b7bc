"""Parameters of the pipeline as tables, for a terminal and for a document."""

from collections.abc import Sequence
from itertools import groupby

from rich.table import Table
from rich.text import Text

from moseg.workflows.cli.tables import console
from moseg.workflows.config.parameter_errors import unknown_parameter
from moseg.workflows.config.parameters import Parameter, list_parameters, list_stages
from moseg.workflows.config.strict_yaml import spell_value

_TITLE = """# Parameters

Every parameter of the pipeline, stage by stage, as `moseg config show --markdown` writes them. Give one on the command
line with `--set`, several in a file with `--config`; see [the command line](command_line.md). A unit of *share* means a
part of what the text names, 1 being all of it; *ratio* has no unit."""


def choose_parameters(name: str | None) -> list[Parameter]:
    """Return the parameter of a name, those of a stage and the stages within it, or all; raises InputError on none."""
    found = [
        parameter
        for parameter in list_parameters().values()
        if name is None or parameter.name == name or parameter.name.startswith(f"{name}.")
    ]
    if not found:
        raise unknown_parameter(name)
    # Parameters without a stage are of one table.
    return sorted(found, key=lambda parameter: len(parameter.path) > 1)


def print_parameters(parameters: Sequence[Parameter]) -> None:
    """Print a table for each stage: as wide as the terminal, its last column broken into lines."""
    out = console()
    for stage, group in groupby(parameters, key=lambda parameter: parameter.path[:-1]):
        name = ".".join(stage)
        about = list_stages().get(name, "Of the whole run.")
        table = Table(title=Text(f"{name}: {about}" if name else about), title_justify="left", pad_edge=False)
        for column in ("name", "default", "range"):
            table.add_column(column, overflow="fold", max_width=26)
        table.add_column("unit", overflow="fold")
        table.add_column("meaning", overflow="fold", ratio=1)
        for parameter in group:
            cells = (parameter.path[-1], spell_value(parameter.default), parameter.values, parameter.unit or "")
            table.add_row(*map(Text, (*cells, parameter.description)))
        out.print(table)


def markdown_tables(parameters: Sequence[Parameter]) -> str:
    """Return the tables as sections of Markdown; for all parameters a whole document."""
    lines = [_TITLE, ""] if len(parameters) == len(list_parameters()) else []
    for stage, group in groupby(parameters, key=lambda parameter: parameter.path[:-1]):
        name = ".".join(stage)
        lines += [f"## {name or 'Of the whole run'}", ""]
        lines += [list_stages()[name], ""] if name else []
        lines += ["| parameter | default | range | unit | meaning |", "|---|---|---|---|---|"]
        for parameter in group:
            cells = (spell_value(parameter.default), parameter.values, parameter.unit or "", parameter.description)
            lines.append(f"| `{parameter.name}` | " + " | ".join(_cell(cell) for cell in cells) + " |")
        lines.append("")
    return "\n".join(lines).rstrip("\n") + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;").replace(">", "&gt;")
