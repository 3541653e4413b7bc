"""Scores of a sequence whose ground truth is a label at points, not at every pixel."""

from collections.abc import Collection, Iterable

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.scores import SequenceScore
from moseg.tasks.metrics.assign_objects import assign_objects
from moseg.tasks.metrics.foreground_scores import score_foreground
from moseg.tasks.metrics.overlaps import Overlaps, add_overlaps, count_overlaps, region_similarity
from moseg.tasks.tracks.labels_at import labels_at

PointPairs = Iterable[tuple[np.ndarray, np.ndarray]]
"""The (predicted, true) labels of the visible points of each frame, uint16 (N,)."""


def sample_points(
    labels: np.ndarray, points: np.ndarray, visible: np.ndarray, truth: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the predicted and the true labels of the points visible in one frame.

    Parameters
    ----------
    labels : uint16 (y, x)
        Predicted labels, at the size of the frames in which the points were labelled.
    points : float64 (N, 2)
        xy, px, pixel centres at integers; those visible lie inside the frame.
    visible : bool (N,)
    truth : uint16 (N,)

    Returns
    -------
    predicted, truth : uint16 (num_visible,)
        The predicted label is that of the pixel that contains the point.
    """
    return labels_at(labels, points[visible]).astype(np.uint16), truth[visible]


def count_point_overlaps(predicted: np.ndarray, truth: np.ndarray) -> Overlaps:
    """Count the points of one frame that each true and each predicted label share; uint16 (N,) both."""
    return count_overlaps(predicted[None], truth[None])


def score_points(frames: PointPairs) -> SequenceScore:
    """Score predicted masks against labelled points over the frames that have any.

    The definitions are those of `score_sequence` with "pixel" replaced by "visible labelled point in a frame". Pu, Ru
    and Fu come from the assignment of predicted objects to true labels that maximises the sum of the pairs' F-measures
    over all frames' points: precision is over the points on predicted objects, recall over the points of moving labels.
    J is the intersection over union of the points that move, mean over frames, and its ``_objects`` form compares each
    true label with the object assigned to it. Predictions at places without a point are ignored, so boundaries are not
    measured and the boundary scores are None.

    Parameters
    ----------
    frames : iterable of (predicted, truth)
        Labels uint16 (N,) of each frame's visible points, 0 = not moving. Frames without points are
        ignored.

    Returns
    -------
    SequenceScore
        In percent; `boundary_F` and `boundary_F_objects` are None.

    Raises
    ------
    InputError
        If no frame has a point.

    References
    ----------
    Dave, Tokmakov, Ramanan, "Towards Segmenting Anything That Moves", ICCV Workshops 2019, section 4.
    """
    per_frame = [count_point_overlaps(predicted, truth) for predicted, truth in frames if truth.size]
    if not per_frame:
        raise InputError("no labelled point to score", got=0, expected="at least 1")
    total = add_overlaps(per_frame)
    true_labels = sorted({truth for truth, _ in total} - {0})
    predicted_labels = {predicted for _, predicted in total} - {0}
    assigned = assign_objects(total)
    foreground = score_foreground(total, assigned)
    region = _mean_similarity(per_frame, true_labels, predicted_labels)
    if true_labels:
        region_objects = np.mean([_mean_similarity(per_frame, {g}, {assigned.get(g)}) for g in true_labels])
    else:
        region_objects = 0.0 if predicted_labels else 1.0
    return SequenceScore(
        P=100 * foreground.precision,
        R=100 * foreground.recall,
        F=100 * foreground.f_measure,
        J=100 * region,
        J_objects=100 * float(region_objects),
    )


def _mean_similarity(per_frame: list[Overlaps], true_labels: Collection[int], predicted_labels: Collection) -> float:
    """Return J of the points of some labels, mean over frames."""
    return float(np.mean([region_similarity(frame, true_labels, predicted_labels) for frame in per_frame]))
