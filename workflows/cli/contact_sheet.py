"""`moseg contact-sheet`."""

from typing import Annotated

import typer

from moseg.schemas.configs import Variant
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import DataOptions, RunOptions, VariantOption
from moseg.workflows.cli.pipeline_options import PipelineOptions


@with_option_groups
def contact_sheet(
    data: DataOptions,
    pipeline: PipelineOptions,
    run: RunOptions,
    out: Annotated[
        str, typer.Option("--out", "-o", help="Folder for one PNG a sequence.", metavar="FOLDER")
    ] = "contact-sheets",
    variant: VariantOption = Variant.FUSED,
    frames: Annotated[
        int,
        typer.Option("--frames", "--columns", min=1, help="Frames of a sheet, spread over the annotated ones."),
    ] = 8,
) -> None:
    """Draw a picture of every sequence: frames, motion saliency, masks and errors against ground truth.

    Examples
    --------
    moseg contact-sheet --dataset synthetic --out sheets
    moseg contact-sheet --dataset davis16 --root DAVIS --sequences dog --frames 5
    """
    from moseg.workflows.api.contact_sheets import run_contact_sheets

    done = run_contact_sheets(data.choice(), pipeline.choices(), run.settings(), variant, out, frames)
    for path in done.paths:
        print(path)
    print(f"{done.use.computed} artifacts computed, {done.use.reused} reused, {done.seconds:.1f} s")
    for note in done.notes:
        print(f"note: {note}")
