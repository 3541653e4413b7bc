"""Evidence that cells at a mask do not move with it: they follow the motion of what is around it better."""

import cv2
import numpy as np

from moseg.schemas.parameters import CarryingParams
from moseg.tasks.saliency.affine_fit import fit_affine
from moseg.tasks.saliency.grid import pixel_grid, squared_length


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
    motions = [fit_affine(flow, among) for among in (share > 0.5, around & (share <= covered))]
    if any(motion is None for motion in motions):
        return np.zeros(share.shape, np.float32)
    own, other = (cv2.transform(pixel_grid(share.shape), motion.astype(np.float32)) for motion in motions)
    closer = squared_length(flow - other) - squared_length(flow - own)
    scale = np.float32(params.motion_noise)
    return np.clip(closer / (2 * scale * scale), -np.float32(params.motion), 0)
