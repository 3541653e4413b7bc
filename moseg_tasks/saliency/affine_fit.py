"""Affine motion that most of some pixels follow, for regions of any shape."""

import numpy as np

from moseg.tasks.saliency.background import MAD_TO_SIGMA, tukey_weight
from moseg.tasks.saliency.grid import squared_length

_MIN_SAMPLES = 12
_MAX_SAMPLES = 600
_ROUNDS = 3
_TUKEY = 4.0  # residual, in scales, from which Tukey's weight is 0
_MIN_SCALE = 0.15  # of the residuals, px/frame


def fit_affine(flow: np.ndarray, among: np.ndarray) -> np.ndarray | None:
    """Fit an affine motion to the flow of some pixels, by iteratively reweighted least squares.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    among : bool (y, x)

    Returns
    -------
    float64 (2, 3) or None
        A motion M moves a pixel by M [x, y, 1]; None where there are fewer than 12 pixels.
    """
    cells = np.flatnonzero(among)
    if len(cells) < _MIN_SAMPLES:
        return None
    cells = cells[:: max(1, len(cells) // _MAX_SAMPLES)]
    y, x = np.divmod(cells, flow.shape[1])
    centre, size = np.array([x.mean(), y.mean()]), float(max(flow.shape[:2]))
    design = np.column_stack([np.ones(len(cells)), (x - centre[0]) / size, (y - centre[1]) / size])
    vectors, weight = flow.reshape(-1, 2)[cells].astype(np.float64), np.ones(len(cells))
    # Cells in a row determine no gradient across it.
    ridge = 1e-6 * len(cells) * np.diag([0.0, 1, 1])
    for _ in range(_ROUNDS):
        weighted = design * weight[:, None]
        theta = np.linalg.solve(weighted.T @ design + ridge, weighted.T @ vectors)
        residual = np.sqrt(squared_length(vectors - design @ theta))
        scale = max(MAD_TO_SIGMA * float(np.median(residual)), _MIN_SCALE)
        weight = tukey_weight(residual, _TUKEY * scale) + 1e-9
    return np.column_stack([theta[1:].T / size, theta[0] - centre @ theta[1:] / size])
