"""`moseg view`."""

from typing import Annotated

import typer

from moseg.schemas.configs import Variant
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import RunOptions, VariantOption
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.cli.segment import FrameOptions

NOT_OF_SEGMENT = ("out", "port", "no_browser", "what", "context")
"""Parameters that the command without the page does not have, or has anew."""


@with_option_groups
def view(
    context: typer.Context,
    frames: FrameOptions,
    pipeline: PipelineOptions,
    run: RunOptions,
    what: Annotated[
        str | None,
        typer.Argument(
            help="A video file, a folder of frames, what `moseg segment` left in a folder, or a run's name; without"
            " any, the page asks for a video.",
            metavar="[VIDEO_OR_RUN]",
        ),
    ] = None,
    out: Annotated[
        str | None,
        typer.Option(
            "--out",
            "-o",
            help="Folder for corrections.yaml and results (default: out, or the folder that is opened).",
            metavar="FOLDER",
        ),
    ] = None,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port of this machine; 0 is any free one.", metavar="N")
    ] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only print the page's address, and open no browser.")
    ] = False,
    variant: VariantOption = Variant.FUSED,
) -> None:
    """Look at a result, correct it and export it, on a page that this machine alone can open.

    A video is segmented first. Corrections are in OUT/corrections.yaml as soon as they are made.

    Examples
    --------
    moseg view holiday.mp4 --out holiday
    moseg view holiday
    moseg view latest --no-browser --port 8000
    """
    from moseg.workflows.view.start import start_view

    chosen, choices = frames.read(), pipeline.choices()
    choices.read()
    options = _given_options(context)
    start_view(what, out, port, not no_browser, choices, chosen, frames.fps, variant, run.settings(), options)


def _given_options(context: typer.Context) -> tuple[str, ...]:
    """Return the words of the options that were given and that `moseg segment` has too."""
    words: list[str] = []
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name)
        if parameter.name in NOT_OF_SEGMENT or source is None or source.name != "COMMANDLINE":
            continue
        value = context.params[parameter.name]
        for each in value if isinstance(value, list | tuple) else [value]:
            words += [parameter.opts[0]] if each is True else [parameter.opts[0], str(each)]
    return tuple(words)
