"""Growth of each object by its flow: it appears larger as it comes nearer, and smaller as it goes away."""

import numpy as np

from moseg.tasks.saliency.affine_fit import fit_affine

_MOST = float(np.log(2))
"""Largest factor on the size from one frame to the next that a flow is believed, its logarithm."""


def flow_growth(labels: np.ndarray, flow: np.ndarray | None, num_objects: int) -> np.ndarray:
    """Return how much larger each object is than in the frame before, by the flow inside its mask.

    What comes nearer grows in all directions. Where parts of an object move towards each other, one of them may have
    stopped: only what both axes of an affine motion agree on counts.

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
        Natural logarithm of the area over that in the frame before; NaN for the background, without flow, where the
        flow folds over, and for an object of fewer than 12 pixels.
    """
    growth = np.full(num_objects, np.nan)
    if flow is None:
        return growth
    for index in np.flatnonzero(np.bincount(labels.ravel(), minlength=num_objects)[1:]) + 1:
        motion = fit_affine(flow, labels == index)
        if motion is not None:
            growth[index] = -_common_growth(np.eye(2) + motion[:, :2])
    return growth


def _common_growth(matrix: np.ndarray) -> float:
    """Return the logarithm of the factor on areas that both axes of a map (2, 2) agree on; NaN where it folds over."""
    if np.linalg.det(matrix) <= 0:
        return np.nan
    axes = np.clip(np.log(np.linalg.svd(matrix, compute_uv=False)), -_MOST, _MOST)
    return 2 * float(np.sign(axes[0]) * np.abs(axes).min()) if axes[0] * axes[1] > 0 else 0.0
