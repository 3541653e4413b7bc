"""Why a fundamental matrix is not determined by the points it was fitted to."""

from enum import IntEnum

import numpy as np

from moseg_tasks.geometry.coordinates import hartley_transform
from moseg_tasks.geometry.eight_point import epipolar_equations


class Degeneracy(IntEnum):
    """Reason code of a fit, stored as uint8; the first that holds, in this order, but for NONE."""

    NONE = 0
    """The points determine the fundamental matrix."""
    TOO_FEW_POINTS = 1
    """Fewer points are visible in both frames than asked for."""
    NO_MODEL = 2
    """The estimator found no model with as many inliers as its equations."""
    COLLINEAR = 3
    """The inliers lie on a line in one of the frames."""
    HOMOGRAPHY = 4
    """A homography explains the points: a plane, a rotating or still camera, or a shallow object."""
    ILL_CONDITIONED = 5
    """The epipolar equations of the inliers leave more than one solution."""


def line_distance(points: np.ndarray) -> float:
    """Root mean square distance of points (N, 2) to their total-least-squares line, in their unit."""
    centred = points - points.mean(axis=0)
    return float(np.linalg.svd(centred, compute_uv=False)[-1] / np.sqrt(len(points)))


def epipolar_conditioning(points0: np.ndarray, points1: np.ndarray) -> float:
    """Eighth over first singular value of the Hartley-normalised epipolar equations of N >= 8 points; 0 = undetermined."""
    A = epipolar_equations(hartley_transform(points0)[0], hartley_transform(points1)[0])
    singular = np.linalg.svd(A, compute_uv=False)
    return float(singular[7] / singular[0])
