"""Pu, Ru and Fu: precision, recall and F-measure that penalise false positives."""

from typing import NamedTuple

from moseg.tasks.metrics.overlaps import Overlaps


class ForegroundScores(NamedTuple):
    """Fractions 0..1."""

    precision: float
    recall: float
    f_measure: float


def score_foreground(overlaps: Overlaps, assigned: dict[int, int]) -> ForegroundScores:
    """Return precision, recall and F-measure of assigned objects against all foreground.

    Precision is the number of shared pixels of the assigned pairs over all predicted foreground, so a predicted object
    without a partner is a false positive; recall is the same number over all true foreground. As in the authors'
    evaluation a share of an empty foreground is 0. If both are empty the prediction is correct: all three are 1. (The
    authors' data have no such sequence; their code would return 0.)

    Parameters
    ----------
    overlaps : Overlaps
        Overlaps of the whole sequence, without void pixels.
    assigned : dict of int to int
        True label to predicted label.

    References
    ----------
    Dave, Tokmakov, Ramanan, "Towards Segmenting Anything That Moves", ICCV Workshops 2019, section 4.
    """
    predicted_area = sum(count for (_, predicted), count in overlaps.items() if predicted)
    true_area = sum(count for (truth, _), count in overlaps.items() if truth)
    if not predicted_area and not true_area:
        return ForegroundScores(1.0, 1.0, 1.0)
    shared = sum(overlaps.get(pair, 0) for pair in assigned.items())
    return ForegroundScores(
        precision=shared / predicted_area if predicted_area else 0.0,
        recall=shared / true_area if true_area else 0.0,
        f_measure=2 * shared / (predicted_area + true_area),
    )
