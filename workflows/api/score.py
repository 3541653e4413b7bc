"""Scoring saved masks of any program by one call."""

import os
from collections.abc import Iterable
from pathlib import Path

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.scores import EvaluationReport, StillReport
from moseg.workflows.api.arguments import Kind, check_kinds, named_as_arguments
from moseg.workflows.api.evaluation import DataChoice, read_data, write_report_json
from moseg.workflows.exports import TextKind, check_replaceable
from moseg.workflows.pipelines.score_predictions import score_predictions
from moseg.workflows.predictions import open_predictions


@named_as_arguments()
def score(
    predictions: str | os.PathLike,
    dataset: str | os.PathLike = "synthetic",
    *,
    root: str | os.PathLike | None = None,
    sequences: str | Iterable[str] | None = None,
    list_file: str | os.PathLike | None = None,
    format: str | None = None,
    name: str | None = None,
    progress: bool = True,
) -> EvaluationReport | StillReport:
    """Score the masks that any program saved: the same scores as `moseg score`, by the metrics of `evaluate`.

    Files are matched to the frames by their names; where no file has a frame's name, in order or by number, which the
    report's ``matching`` and ``notes`` say. Every frame with ground truth needs a mask.

    Parameters
    ----------
    predictions : path
        Folder of saved masks: PNGs, ``.npy`` or ``.npz`` volumes, or what MoSeg, Raptor, RigidMask and EM write.
    dataset, root, sequences, list_file
        Sequences to score, as of `evaluate`.
    format : str, optional
        Format of the masks; by default found from the names of the files.
    name : str, optional
        Of the report's row; by default that of the folder.
    progress : bool
        Whether progress goes to standard error. Standard output is never written to.

    Returns
    -------
    EvaluationReport or StillReport
        Percentages 0..100 of every sequence and their mean.

    Raises
    ------
    InputError
        The data set is not there, a sequence has no ground truth, or masks are missing, damaged or of another size.

    Examples
    --------
    >>> report = score("results/480p", "davis16", root="DAVIS")  # doctest: +SKIP
    >>> report.rows[0].mean.J  # doctest: +SKIP
    81.6
    """
    check_kinds(Kind.PATH, predictions=predictions)
    check_kinds(Kind.TEXT, optional=True, format=format, name=name)
    check_kinds(Kind.SWITCH, progress=progress)
    data = read_data(dataset, root, sequences, list_file)
    return run_score(os.fsdecode(predictions), data, format, name, quiet=not progress)


def run_score(
    predictions: str,
    data: DataChoice,
    format: str | None,
    name: str | None,
    json: str | None = None,
    quiet: bool = False,
) -> EvaluationReport | StillReport:
    """Score saved masks as `score` does, and write the report to the file `json` where one is given."""
    if json is not None:
        check_replaceable(json, TextKind.JSON)
    saved = open_predictions(Path(predictions), format)
    dataset = data.open(PipelineConfig().max_side)
    report = score_predictions(dataset, saved, name or Path(os.path.abspath(predictions)).name, quiet)
    if json is not None:
        write_report_json(json, report)
    return report
