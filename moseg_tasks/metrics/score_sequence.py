"""All scores of one sequence, with one frame in memory at a time."""

from collections.abc import Callable, Iterable, Iterator, Mapping

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.scores import SequenceScore
from moseg.tasks.metrics.assign_objects import assign_objects
from moseg.tasks.metrics.boundary_similarity import boundary_similarity
from moseg.tasks.metrics.foreground_scores import score_foreground
from moseg.tasks.metrics.overlaps import Overlaps, add_overlaps, count_overlaps, region_similarity

FramePairs = Callable[[], Iterable[tuple[np.ndarray, np.ndarray]]]
"""Function that starts a new pass over the (predicted, truth) label images of the annotated frames."""


def score_sequence(frames: FramePairs, void: int | None = None) -> SequenceScore:
    """Score predicted against annotated moving objects over a sequence's annotated frames.

    Pu, Ru and Fu come from (frame, y, x) masks under the assignment of `assign_objects`. J and boundary F compare the
    unions of all objects; their ``_objects`` forms compare each true object with the predicted object assigned to it,
    or with an empty mask if there is none. Each is the mean over all annotated frames, including first and last, and
    then over objects. In a frame in which both masks are empty they are 1.

    A sequence without true objects scores 100 everywhere if nothing is predicted; else it scores 0, except in frames in
    which J and boundary F compare empty masks. A sequence with true objects and an empty prediction has P = R = F = 0.

    Parameters
    ----------
    frames : callable returning an iterable of (predicted, truth)
        Label images, uint8 or uint16 (y, x), 0 = not moving, of each annotated frame. It is called a second time for
        several objects: the boundary of an object can only be scored after its partner is known.
    void : int, optional
        True label of pixels that are ignored. Predicted labels are never void.

    Returns
    -------
    SequenceScore
        In percent.

    Raises
    ------
    InputError
        If there is no annotated frame or a pair is not two label images of one size.
    """
    per_frame: list[Overlaps] = []
    boundary: list[float] = []
    for predicted, truth in frames():
        per_frame.append(count_overlaps(predicted, truth, void))
        boundary.append(boundary_similarity(_outside(truth, void, predicted > 0), _outside(truth, void, truth > 0)))
    if not per_frame:
        raise InputError("no annotated frame to score", got=0, expected="at least 1")
    total = add_overlaps(per_frame)
    true_labels = {truth for truth, _ in total} - {0}
    predicted_labels = {predicted for _, predicted in total} - {0}
    assigned = assign_objects(total)
    foreground = score_foreground(total, assigned)
    region = [region_similarity(overlaps, true_labels, predicted_labels) for overlaps in per_frame]
    if len(true_labels) <= 1 and predicted_labels == set(assigned.values()):
        region_objects, boundary_objects = region, boundary
    elif not true_labels:
        region_objects = boundary_objects = [0.0]
    else:
        partners = {label: assigned.get(label) for label in sorted(true_labels)}
        region_objects = _object_regions(per_frame, partners)
        boundary_objects = _object_boundaries(frames(), partners, void)
    return SequenceScore(
        P=100 * foreground.precision,
        R=100 * foreground.recall,
        F=100 * foreground.f_measure,
        J=_percent(region),
        boundary_F=_percent(boundary),
        J_objects=_percent(region_objects),
        boundary_F_objects=_percent(boundary_objects),
    )


def _object_regions(per_frame: list[Overlaps], partners: Mapping[int, int | None]) -> Iterator[float]:
    """Yield J of each object in each frame."""
    for overlaps in per_frame:
        for label, partner in partners.items():
            yield region_similarity(overlaps, {label}, {partner})


def _object_boundaries(
    frames: Iterable[tuple[np.ndarray, np.ndarray]], partners: Mapping[int, int | None], void: int | None
) -> Iterator[float]:
    """Yield boundary F of each object in each frame."""
    for predicted, truth in frames:
        for label, partner in partners.items():
            in_prediction = predicted == partner if partner is not None else np.zeros(predicted.shape, dtype=bool)
            yield boundary_similarity(_outside(truth, void, in_prediction), truth == label)


def _outside(truth: np.ndarray, void: int | None, mask: np.ndarray) -> np.ndarray:
    """Return the mask without void pixels."""
    return mask if void is None else mask & (truth != void)


def _percent(fractions: Iterable[float]) -> float:
    """Return the mean in percent."""
    return 100 * float(np.mean(list(fractions)))
