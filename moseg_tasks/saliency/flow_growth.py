"""Growth of each object by its flow: it appears larger as it comes nearer, and smaller as it goes away."""

import numpy as np

from moseg.tasks.saliency.affine_fit import fit_affine

_MOST = 4.0
"""Largest factor of an area from one frame to the next that a flow is believed."""


def flow_growth(labels: np.ndarray, flow: np.ndarray | None, num_objects: int) -> np.ndarray:
    """Return how much larger each object is than in the frame before, by the flow inside its mask.

    Parameters
    ----------
    labels : integer (y, x)
        Object of each pixel of the working grid; 0 = background.
    flow : float32 (y, x, 2) or None
        Flow to the previous frame, px; None where there is none.
    num_objects : int
        Number of labels, that of the background included.

    Returns
    -------
    float64 (num_objects,)
        Natural logarithm of the area over that in the frame before; NaN for the background, without flow, and for an
        object of fewer than 12 pixels.
    """
    growth = np.full(num_objects, np.nan)
    if flow is None:
        return growth
    for index in np.flatnonzero(np.bincount(labels.ravel(), minlength=num_objects)[1:]) + 1:
        motion = fit_affine(flow, labels == index)
        if motion is not None:
            before = float(np.linalg.det(np.eye(2) + motion[:, :2]))
            growth[index] = -np.log(np.clip(before, 1 / _MOST, _MOST))
    return growth
