"""Evidence that cells at a mask do not move with it: they follow the motion of what is around it better."""

import cv2
import numpy as np

from moseg.schemas.parameters import CarryingParams
from moseg.tasks.saliency.background import MAD_TO_SIGMA, tukey_weight
from moseg.tasks.saliency.grid import pixel_grid, squared_length

_MIN_SAMPLES = 12
_MAX_SAMPLES = 600
_ROUNDS = 3
_TUKEY = 4.0  # residual, in scales, from which Tukey's weight is 0
_MIN_SCALE = 0.15  # of the residuals, px/frame


def strays_from_mask(flow: np.ndarray, share: np.ndarray, covered: float, params: CarryingParams) -> np.ndarray:
    """Return evidence, in nats and at most 0, that cells do not belong to a mask by their motion.

    Both motions are affine and fitted robustly: that of the cells inside the mask, and that of the cells around it.
    Where they are alike, as between parts of one object, there is no evidence. Nor is there evidence for the mask: the
    flow of an object reaches past its outline.

    Parameters
    ----------
    flow : float32 (h, w, 2)
        px of the grid per frame.
    share : float32 (h, w)
        Share of each cell that the mask covers, 0..1.
    covered : float
        Share from which a cell is not around the mask, but part of it.
    params : CarryingParams
    """
    side = 2 * params.surroundings + 1
    around = cv2.dilate((share > covered).astype(np.uint8), np.ones((side, side), np.uint8)) > 0
    own, other = _fit_affine(flow, share > 0.5), _fit_affine(flow, around & (share <= covered))
    if own is None or other is None:
        return np.zeros(share.shape, np.float32)
    closer = squared_length(flow - other) - squared_length(flow - own)
    scale = np.float32(params.motion_noise)
    return np.clip(closer / (2 * scale * scale), -np.float32(params.motion), 0)


def _fit_affine(flow: np.ndarray, among: np.ndarray) -> np.ndarray | None:
    """Return the affine flow float32 (h, w, 2) that most of some cells follow; None where they are too few."""
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
    matrix = np.column_stack([theta[1:].T / size, theta[0] - centre @ theta[1:] / size])
    return cv2.transform(pixel_grid(flow.shape[:2]), matrix.astype(np.float32))
