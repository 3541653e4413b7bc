"""Frames of a sequence that pictures show, and their labelled points."""

from collections.abc import Sequence

import numpy as np

from moseg.store import ArtifactStore
from moseg.workflows.exports.draw_errors import PointLabels
from moseg.workflows.graph import SequenceLeaves
from moseg.workflows.sources import LabelledPoints
from moseg.workflows.sources.resize import resize_labels


def spread(num_items: int, num_chosen: int) -> tuple[int, ...]:
    """Return positions of at most `num_chosen` of some items: the middles of runs of equal length."""
    count = min(num_items, num_chosen)
    return tuple((2 * index + 1) * num_items // (2 * count) for index in range(count))


def scored_frames(store: ArtifactStore, leaves: SequenceLeaves) -> Sequence[int]:
    """Return the frames that are scored; all frames if there is no ground truth."""
    if leaves.annotation is not None:
        return annotated_frames(store, leaves.annotation)
    if leaves.labelled_points is not None:
        return np.flatnonzero(store.read(leaves.labelled_points, "visible").any(axis=0)).tolist()
    return range(len(leaves.frames))


def annotated_frames(store: ArtifactStore, annotation: str) -> list[int]:
    """Return the frames that have ground truth."""
    return store.attributes(annotation)["indices"]


def read_labelled_points(store: ArtifactStore, labelled_points: str) -> LabelledPoints:
    """Return all labelled points of a sequence; an array is read whole, so call this once for all frames."""
    arrays = (store.read(labelled_points, name) for name in ("points", "visible", "labels"))
    return LabelledPoints(*arrays, tuple(store.attributes(labelled_points)["size"]))


def label_points(labelled: LabelledPoints, frame: int, labels: np.ndarray) -> PointLabels:
    """Return the points visible in a frame, with their predicted and true labels."""
    # Here, because a program starts without SciPy.
    from moseg.tasks.metrics import sample_points

    points, visible = labelled.points[:, frame], labelled.visible[:, frame]
    found = sample_points(resize_labels(labels, labelled.size), points, visible, labelled.labels)
    return PointLabels(points[visible], *found, labelled.size)
