"""`moseg score`."""

from pathlib import Path
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
    import time

    from moseg.schemas.configs import PipelineConfig
    from moseg.schemas.scores import EvaluationReport, EvaluationRow, StoreUse, mean_score
    from moseg.workflows.cli.tables import print_report
    from moseg.workflows.exports import check_writable, write_text
    from moseg.workflows.pipelines.score_predictions import score_predictions
    from moseg.workflows.predictions import open_predictions

    started = time.perf_counter()
    if json is not None:
        check_writable(json)
    saved = open_predictions(Path(predictions), format)
    dataset = data.open(PipelineConfig().max_side)
    scored = score_predictions(dataset, saved, quiet)
    mean = mean_score(list(scored.scores.values()))
    row = EvaluationRow(variant=name or Path(predictions).resolve().name, sequences=scored.scores, mean=mean)
    report = EvaluationReport(
        dataset=dataset.name,
        over=scored.over,
        rows=(row,),
        matching=scored.matching,
        store=StoreUse(computed=0, reused=0),
        seconds=time.perf_counter() - started,
    )
    print_report(report, (*(f"{absent} is not on disk" for absent in dataset.absent), *scored.notes))
    if json is not None:
        write_text(json, report.model_dump_json(indent=2, exclude_none=True) + "\n")
