"""Boundary F: contour accuracy of DAVIS, by dilated boundaries."""

import math

import cv2
import numpy as np

BOUNDARY_TOLERANCE = 0.008
"""Fraction of the image diagonal within which boundaries agree, as in the DAVIS evaluation."""


def boundary_similarity(predicted: np.ndarray, truth: np.ndarray, tolerance: float = BOUNDARY_TOLERANCE) -> float:
    """Return the F-measure of the boundary pixels of two masks that lie near the other's boundary.

    Precision is the share of the predicted boundary within ``ceil(tolerance * diagonal)`` px of the true one, recall
    the share of the true boundary within that distance of the predicted one. If no mask has a boundary the result is
    1, if only one has none it is 0.

    Parameters
    ----------
    predicted, truth : bool (y, x)
        Masks of the whole frame, void pixels set to False in both.
    tolerance : float
        Fraction of the frame's diagonal.

    References
    ----------
    Perazzi et al., "A Benchmark Dataset and Evaluation Methodology for Video Object Segmentation", CVPR 2016;
    Martin, Fowlkes, Malik, "Learning to Detect Natural Image Boundaries", PAMI 2004.
    """
    radius = math.ceil(tolerance * math.hypot(*truth.shape))
    region = _surroundings(predicted | truth)
    predicted_boundary = boundary_map(predicted[region])
    true_boundary = boundary_map(truth[region])
    num_predicted = np.count_nonzero(predicted_boundary)
    num_true = np.count_nonzero(true_boundary)
    if not num_predicted or not num_true:
        return float(num_predicted == num_true)
    precision = np.count_nonzero(predicted_boundary & _dilate(true_boundary, radius)) / num_predicted
    recall = np.count_nonzero(true_boundary & _dilate(predicted_boundary, radius)) / num_true
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


def boundary_map(mask: np.ndarray) -> np.ndarray:
    """Return the pixels that differ from their right, lower or lower right neighbour.

    The boundary is one pixel wide and lies half a pixel towards the origin. The frame's border is no boundary.

    Parameters
    ----------
    mask : bool (y, x)

    Returns
    -------
    bool (y, x)
    """
    boundary = np.zeros_like(mask)
    boundary[:, :-1] |= mask[:, :-1] != mask[:, 1:]
    boundary[:-1, :] |= mask[:-1, :] != mask[1:, :]
    boundary[:-1, :-1] |= mask[:-1, :-1] != mask[1:, 1:]
    return boundary


def _surroundings(mask: np.ndarray) -> tuple[slice, slice]:
    """Return the mask's bounding box and one pixel around it, which contain every boundary pixel."""
    x, y, width, height = cv2.boundingRect(mask.view(np.uint8))
    return slice(max(y - 1, 0), y + height + 1), slice(max(x - 1, 0), x + width + 1)


def _dilate(mask: np.ndarray, radius: int) -> np.ndarray:
    """Return the pixels at most `radius` px from the mask."""
    offset = np.arange(-radius, radius + 1)
    disk = (offset[:, None] ** 2 + offset**2 <= radius**2).astype(np.uint8)
    return cv2.dilate(mask.view(np.uint8), disk).view(bool)
