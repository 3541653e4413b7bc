"""Scoring masks that any program saved, with the same metrics as an evaluation."""

import time
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from moseg.schemas.scores import AnyReport, AnyScore, GroundTruth, StoreUse, make_report
from moseg.workflows.datasets import Dataset, SequenceSource, find_ground_truth
from moseg.workflows.predictions import FrameList, Predictions, SequencePredictions
from moseg.workflows.process.progress import StageProgress
from moseg.workflows.sources.frame_matching import Matching, frame_stems

_WAYS = {
    Matching.ORDER: "masks taken for the frames in order, not by name",
    Matching.NUMBER: "masks taken for the frames by their number, counted from 0, not by name",
}
_REPEATS = "no mask of the last frame, which is scored with that of the frame before"
_SOFT = "more than 64 labels in a frame, each scored as an object; a soft mask must be thresholded first"
_MANY_LABELS = 64


class _CountedLabels:
    """Saved masks of a sequence, and whether a frame that was read has more labels than objects are likely."""

    def __init__(self, saved: SequencePredictions):
        self._saved = saved
        self.are_many = False

    def frame(self, index: int) -> np.ndarray:
        """Return the labels of a frame, bool or integer (y, x)."""
        labels = self._saved.frame(index)
        if not self.are_many and labels.max(initial=0) > _MANY_LABELS:
            self.are_many = len(np.unique(labels)) > _MANY_LABELS
        return labels


def score_predictions(dataset: Dataset, predictions: Predictions, name: str, quiet: bool = False) -> AnyReport:
    """Score the saved masks of every sequence of a data set by its kind of ground truth.

    Parameters
    ----------
    name : str
        Of the report's only row.
    quiet : bool
        No progress on standard error.

    Returns
    -------
    EvaluationReport or StillReport
        Its notes say which masks were not matched by name, which were used twice, and which look soft.

    Raises
    ------
    InputError
        A sequence without ground truth, or sequences of several kinds; predictions that are missing, damaged, of the
        wrong size, or of unknown frames.
    """
    started = time.perf_counter()
    sources = [dataset.sequence(name) for name in dataset.names]
    over = find_ground_truth(sources)
    scores, matching, repeating, soft = {}, {}, [], []
    with StageProgress({"score": len(dataset.names)}, quiet) as progress:
        for source in sources:
            frames = FrameList(source.frames.num_frames(), frame_stems(source.frames))
            saved = predictions.sequence(source.name, frames, source.frames.describe().size)
            scored: set[int] = set()
            counted = _CountedLabels(saved)
            scores[source.name] = _score(over, source, counted, frames.num_frames, scored)
            matching[source.name] = saved.matching
            if saved.repeats_last and frames.num_frames - 1 in scored:
                repeating.append(source.name)
            if counted.are_many:
                soft.append(source.name)
            progress.advance("score")
    return make_report(
        over,
        {name: scores},
        dataset=dataset.name,
        matching=matching,
        store=StoreUse(computed=0, reused=0),
        seconds=time.perf_counter() - started,
        notes=(*(f"{absent} is not on disk" for absent in dataset.absent), *_notes(matching, repeating, soft)),
    )


def _score(
    over: GroundTruth, source: SequenceSource, saved: _CountedLabels, num_frames: int, scored: set[int]
) -> AnyScore:
    """Return the score of one sequence; the frames that count are added to `scored`."""
    # Here, because a program starts without SciPy.
    from moseg.tasks.metrics import score_points, score_sequence, score_still

    if over == "still":
        scored.update(range(num_frames))
        return score_still(map(saved.frame, range(num_frames)))
    if over == "points":
        return score_points(_saved_points(source, saved, scored))
    return score_sequence(partial(_saved_frames, source, saved, scored), void=source.void)


def _saved_frames(
    source: SequenceSource, saved: _CountedLabels, scored: set[int]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield pairs of saved and annotated labels of each frame; their frames are added to `scored`."""
    for index, truth in source.annotations.read():
        scored.add(index)
        yield saved.frame(index), truth


def _saved_points(
    source: SequenceSource, saved: _CountedLabels, scored: set[int]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield saved and true labels of the visible points of every frame in which there are any, added to `scored`."""
    from moseg.tasks.metrics import sample_points

    points, visible, truth, _ = source.labelled_points.read()
    for index in np.flatnonzero(visible.any(axis=0)):
        scored.add(int(index))
        yield sample_points(saved.frame(int(index)), points[:, index], visible[:, index], truth)


def _notes(matching: Mapping[str, Matching], repeating: Sequence[str], soft: Sequence[str]) -> tuple[str, ...]:
    found = {words: [name for name, each in matching.items() if each == way] for way, words in _WAYS.items()}
    found |= {_REPEATS: repeating, _SOFT: soft}
    return tuple(f"{words}: {', '.join(names)}" for words, names in found.items() if names)
