"""`moseg score`."""

from typing import Annotated

import typer

from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import DataOptions, JsonOption, QuietOption


@with_option_groups
def score(
    predictions: Annotated[str, typer.Option("--predictions", help="Folder of saved masks.")],
    data: DataOptions,
    format: Annotated[
        str | None, typer.Option("--format", help="Format of the masks (default: found from the files' names).")
    ] = None,
    name: Annotated[str | None, typer.Option("--name", help="Name of the row (default: the folder's).")] = None,
    json: JsonOption = None,
    quiet: QuietOption = False,
) -> None:
    """Score anybody's saved masks (PNG folders, .npy/.npz volumes, what MoSeg, Raptor, RigidMask and EM write).

    Files are matched to the frames by their names. Where no file has a frame's name, they are taken in order, one for
    each frame, or else by their number from 0, and a note says so. Every frame with ground truth needs a mask.

    Examples
    --------
    moseg score --dataset davis16 --root DAVIS --predictions results/480p
    moseg score --dataset davis16 --predictions masks --name mine --json mine.json
    """
    from moseg.workflows.api.score import run_score
    from moseg.workflows.cli.tables import print_report

    print_report(run_score(predictions, data.choice(), format, name, json, quiet))
