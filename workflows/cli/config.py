"""`moseg config`: the parameters of the pipeline, what they mean, and files of them."""

from pathlib import Path
from typing import Annotated

import typer

from moseg.workflows.cli import completion
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.pipeline_options import PipelineOptions

config_app = typer.Typer(
    help="""Parameters of the pipeline: what each means, and files of them for --config.

    Examples
    --------
    moseg config show fundamental
    moseg config dump --preset paper --out paper.yaml
    """,
    no_args_is_help=False,
)


@config_app.command("show")
def show(
    name: Annotated[
        str | None,
        typer.Argument(
            help="A stage, or a parameter as stage.name (default: all).",
            metavar="[STAGE[.NAME]]",
            autocompletion=completion.complete_stage,
        ),
    ] = None,
    markdown: Annotated[bool, typer.Option("--markdown", help="Tables for a document.")] = False,
) -> None:
    """Show the parameters: default, range, unit and meaning of each.

    Examples
    --------
    moseg config show
    moseg config show tracks
    moseg config show clustering.count.gap
    """
    from moseg.workflows.cli.parameter_tables import choose_parameters, markdown_tables, print_parameters

    chosen = choose_parameters(name)
    if markdown:
        print(markdown_tables(chosen), end="")
    else:
        print_parameters(chosen)


@config_app.command("dump")
@with_option_groups
def dump(
    pipeline: PipelineOptions,
    out: Annotated[
        str | None, typer.Option("--out", "-o", help="File to write (default: standard output).", metavar="FILE")
    ] = None,
    changed: Annotated[bool, typer.Option("--changed", help="Only what differs from the defaults.")] = False,
) -> None:
    """Write the configuration that these options make, as YAML with a comment on every parameter.

    A run with `--config` and this file has exactly this configuration, and so finds the same artifacts.

    Examples
    --------
    moseg config dump --out my-config.yaml
    moseg config dump --preset paper --geometry paper --out paper.yaml
    moseg config dump --config my-config.yaml --set tracks.border=8 --changed
    """
    from moseg.workflows.config.config_files import write_config
    from moseg.workflows.exports import TextKind, check_replaceable, write_text

    if out is not None:
        check_replaceable(Path(out), TextKind.YAML)
    text = write_config(pipeline.choices().read(), changed_only=changed)
    if out is None:
        print(text, end="")
    else:
        write_text(Path(out), text)
