"""`moseg contact-sheet`."""

from pathlib import Path
from typing import Annotated

import typer

from moseg.schemas.configs import Variant
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import DataOptions, RunOptions
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.notes import motions_note


@with_option_groups
def contact_sheet(
    data: DataOptions,
    pipeline: PipelineOptions,
    run: RunOptions,
    out: Annotated[
        str, typer.Option("--out", help="Folder for one PNG a sequence.", metavar="FOLDER")
    ] = "contact-sheets",
    variant: Annotated[
        Variant,
        typer.Option(
            "--variant", help="Row of the paper's ablation: fused, oc-depth, oc, trajs or base.", metavar="NAME"
        ),
    ] = Variant.FUSED,
    frames: Annotated[
        int,
        typer.Option("--frames", "--columns", min=1, help="Frames of a sheet, spread over the annotated ones."),
    ] = 8,
) -> None:
    """A picture of every sequence: frames, motion saliency, masks and errors against ground truth.

    Examples
    --------
    moseg contact-sheet --dataset synthetic --out sheets
    moseg contact-sheet --dataset davis16 --root DAVIS --sequences dog --frames 5
    """
    from moseg.workflows.datasets.given_folders import with_given_folders
    from moseg.workflows.exports import check_folder
    from moseg.workflows.pipelines.contact_sheets import write_contact_sheets

    config, folders = pipeline.read()
    check_folder(Path(out))
    dataset = data.open(config.max_side)
    sources = [with_given_folders(dataset.sequence(name), folders, config.max_side) for name in dataset.names]
    with run.open() as session:
        paths = write_contact_sheets(session, sources, config, variant, Path(out), frames)
    for path in paths:
        print(path)
    use = session.use()
    print(f"{use.computed} artifacts computed, {use.reused} reused, {session.seconds:.1f} s")
    for note in (*motions_note(config), *(f"{absent} is not on disk" for absent in dataset.absent)):
        print(f"note: {note}")
