"""Pixels that each pair of a true and a predicted label shares, and J, the Jaccard index that follows from them."""

from collections import Counter
from collections.abc import Collection, Iterable

import numpy as np

from moseg.schemas.errors import InputError

_FEW_LABELS = 256

Overlaps = dict[tuple[int, int], int]
"""Pixels by (true label, predicted label), including background (0), without pairs that share no pixel."""


def count_overlaps(predicted: np.ndarray, truth: np.ndarray, void: int | None = None) -> Overlaps:
    """Count the pixels that each true and each predicted label share in one frame.

    Parameters
    ----------
    predicted, truth : unsigned integer (y, x)
        Labels; 0 is the background.
    void : int, optional
        True label of pixels that are ignored.

    Raises
    ------
    InputError
        If the two are not label images of one size.
    """
    _check_labels(predicted, truth)
    predicted_labels, predicted_index = _index_labels(predicted)
    true_labels, true_index = _index_labels(truth)
    width = len(predicted_labels)
    cell = true_index.astype(np.intp)
    cell *= width
    cell += predicted_index
    joint = np.bincount(cell.ravel(), minlength=len(true_labels) * width)
    joint = joint.reshape(len(true_labels), width)
    rows, columns = np.nonzero(joint)
    return {
        (int(true_labels[row]), int(predicted_labels[column])): int(joint[row, column])
        for row, column in zip(rows, columns, strict=True)
        if true_labels[row] != void
    }


def add_overlaps(frames: Iterable[Overlaps]) -> Overlaps:
    """Sum the overlaps of several frames to those of the (frame, y, x) volumes."""
    total: Counter = Counter()
    for overlaps in frames:
        total.update(overlaps)
    return dict(total)


def region_similarity(overlaps: Overlaps, true_labels: Collection[int], predicted_labels: Collection[int]) -> float:
    """Return the intersection over union of a true and a predicted mask in one frame, 1 if both are empty.

    Parameters
    ----------
    overlaps : Overlaps
        Overlaps of the frame, without void pixels.
    true_labels, predicted_labels : collection of int
        Labels of the pixels of each mask.

    References
    ----------
    Perazzi et al., "A Benchmark Dataset and Evaluation Methodology for Video Object Segmentation", CVPR 2016.
    """
    intersection = union = 0
    for (truth, predicted), count in overlaps.items():
        in_truth, in_prediction = truth in true_labels, predicted in predicted_labels
        intersection += count * (in_truth and in_prediction)
        union += count * (in_truth or in_prediction)
    return intersection / union if union else 1.0


def _index_labels(labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return labels, ascending, and each pixel's position among them; of many labels only those that occur."""
    num_labels = int(labels.max(initial=0)) + 1
    if num_labels <= _FEW_LABELS:
        return np.arange(num_labels), labels
    occurs = np.bincount(labels.ravel()) > 0
    position = np.cumsum(occurs) - 1
    return np.flatnonzero(occurs), position[labels]


def _check_labels(predicted: np.ndarray, truth: np.ndarray) -> None:
    """Raise InputError unless both are label images of one size."""
    for name, labels in (("prediction", predicted), ("ground truth", truth)):
        if labels.ndim != 2 or labels.dtype not in (np.uint8, np.uint16):
            got = f"{labels.dtype} {labels.shape}"
            raise InputError("not a label image", where=name, got=got, expected="uint8 or uint16 (y, x)")
    if predicted.shape != truth.shape:
        raise InputError("wrong size", where="prediction", got=predicted.shape, expected=truth.shape)
