"""Assignment of predicted objects to ground-truth objects."""

import numpy as np
from scipy.optimize import linear_sum_assignment

from moseg.tasks.metrics.overlaps import Overlaps

# Below any significant difference of two sums of F-measures, above their rounding error.
_TIE_WEIGHT = 1e-9


def assign_objects(overlaps: Overlaps) -> dict[int, int]:
    """Assign predicted to true objects one to one so that the sum of the pairs' F-measures is maximal.

    The F-measure of a pair is that of their (frame, y, x) masks, ``2 |c and g| / (|c| + |g|)``. Of assignments of
    equal sum the one with most shared pixels is taken, so that scores do not depend on the numbers of objects.

    Parameters
    ----------
    overlaps : Overlaps
        Overlaps of the whole sequence, without void pixels.

    Returns
    -------
    dict of int to int
        True label to predicted label; without objects that have no partner, or a partner that shares no pixel.

    References
    ----------
    Dave, Tokmakov, Ramanan, "Towards Segmenting Anything That Moves", ICCV Workshops 2019, section 4.
    """
    true_labels = sorted({truth for truth, _ in overlaps if truth})
    predicted_labels = sorted({predicted for _, predicted in overlaps if predicted})
    if not true_labels or not predicted_labels:
        return {}
    shared = np.array([[overlaps.get((g, c), 0) for c in predicted_labels] for g in true_labels], dtype=np.float64)
    true_area = np.array([sum(n for (g, _), n in overlaps.items() if g == label) for label in true_labels])
    predicted_area = np.array([sum(n for (_, c), n in overlaps.items() if c == label) for label in predicted_labels])
    f_measure = 2 * shared / (true_area[:, None] + predicted_area)
    rows, columns = linear_sum_assignment(f_measure + _TIE_WEIGHT * shared / true_area.sum(), maximize=True)
    return {
        true_labels[row]: predicted_labels[column]
        for row, column in zip(rows, columns, strict=True)
        if shared[row, column]
    }
