"""Scoring masks that any program saved, with the same metrics as an evaluation."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from moseg_tasks.metrics import sample_points, score_points, score_sequence
from schemas.scores import GroundTruth, SequenceScore
from workflows.datasets import Dataset, SequenceSource, find_ground_truth
from workflows.predictions import Predictions
from workflows.progress import StageProgress


def score_predictions(
    dataset: Dataset, predictions: Predictions, quiet: bool = False
) -> tuple[GroundTruth, dict[str, SequenceScore]]:
    """Score the saved masks of every sequence of a data set, against masks or at labelled points.

    Returns
    -------
    over : 'pixels' or 'points'
        What the scores count.
    scores : dict of str to SequenceScore

    Raises
    ------
    InputError
        A sequence without ground truth, or sequences of both kinds; predictions that are missing, damaged or of the
        wrong size.
    """
    sources = [dataset.sequence(name) for name in dataset.names]
    over = find_ground_truth(sources)
    scores = {}
    with StageProgress({"score": len(dataset.names)}, quiet) as progress:
        for source in sources:
            if over == "points":
                scores[source.name] = score_points(_saved_points(source, predictions))
            else:
                scores[source.name] = score_sequence(partial(_saved_frames, source, predictions), void=source.void)
            progress.advance("score")
    return over, scores


def _saved_frames(source: SequenceSource, predictions: Predictions) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of saved and annotated labels, one frame at a time."""
    saved = None
    for index, truth in source.annotations.read():
        if saved is None:
            saved = predictions.sequence(source.name, source.frames.num_frames(), truth.shape)
        yield saved.frame(index), truth


def _saved_points(source: SequenceSource, predictions: Predictions) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Saved and true labels of the visible points of every frame in which there are any."""
    points, visible, truth = source.labelled_points.read()
    saved = predictions.sequence(source.name, visible.shape[1], source.labelled_points.size)
    for index in np.flatnonzero(visible.any(axis=0)):
        yield sample_points(saved.frame(int(index)), points[:, index], visible[:, index], truth)
