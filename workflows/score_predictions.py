"""Scoring masks that any program saved, with the same metrics as an evaluation."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from moseg_tasks.metrics import score_sequence
from schemas.errors import InputError
from schemas.scores import SequenceScore
from workflows.datasets import Dataset, SequenceSource
from workflows.predictions import Predictions
from workflows.progress import StageProgress


def score_predictions(dataset: Dataset, predictions: Predictions, quiet: bool = False) -> dict[str, SequenceScore]:
    """Score the saved masks of every sequence of a data set.

    Raises
    ------
    InputError
        A sequence without ground truth; predictions that are missing, damaged or of the wrong size.
    """
    scores = {}
    with StageProgress({"score": len(dataset.names)}, quiet) as progress:
        for name in dataset.names:
            source = dataset.sequence(name)
            if source.annotations is None:
                raise InputError("no ground truth to score against", where=f"sequence {name}")
            scores[name] = score_sequence(partial(_saved_frames, source, predictions), void=source.void)
            progress.advance("score")
    return scores


def _saved_frames(source: SequenceSource, predictions: Predictions) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of saved and annotated labels, one frame at a time."""
    saved = None
    for index, truth in source.annotations.read():
        if saved is None:
            saved = predictions.sequence(source.name, source.frames.num_frames(), truth.shape)
        yield saved.frame(index), truth
