"""Reasons why points do not determine the fundamental matrix fitted to them."""

from enum import IntEnum

import numpy as np

from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry.coordinates import hartley_transform
from moseg.tasks.geometry.eight_point import SAMPLE_SIZE, epipolar_equations


class Degeneracy(IntEnum):
    """Reason code of a fit, stored as uint8: the first that applies, in this order."""

    NONE = 0
    """The points determine the fundamental matrix."""
    TOO_FEW_POINTS = 1
    """Fewer points are visible in both frames than required."""
    NO_MODEL = 2
    """No fundamental matrix was found with as many inliers as the eight-point algorithm needs."""
    COLLINEAR = 3
    """The inliers lie on a line in one of the frames."""
    HOMOGRAPHY = 4
    """A homography explains the points: a plane, a rotating or still camera, or a shallow object."""
    ILL_CONDITIONED = 5
    """The epipolar equations of the inliers have more than one solution."""


def find_degeneracy(
    points0: np.ndarray,
    points1: np.ndarray,
    inlier_mask: np.ndarray,
    num_homography: int,
    params: FundamentalParams,
    scale: float,
) -> Degeneracy:
    """Return why the inliers of a fundamental matrix do not determine it, or NONE.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        In normalised coordinates.
    inlier_mask : bool (N,)
        Inliers of the fundamental matrix.
    num_homography : int
        Inliers of the best homography of the N points, under the same threshold.
    params : FundamentalParams
    scale : float
        px per unit of the coordinates.

    Returns
    -------
    Degeneracy

    References
    ----------
    O. Chum, T. Werner and J. Matas, Two-view geometry estimation unaffected by a dominant plane, CVPR 2005.
    """
    num_inliers = int(inlier_mask.sum())
    if num_inliers < SAMPLE_SIZE:
        return Degeneracy.NO_MODEL
    inliers0, inliers1 = points0[inlier_mask], points1[inlier_mask]
    if min(line_distance(inliers0), line_distance(inliers1)) * scale < params.collinear_width:
        return Degeneracy.COLLINEAR
    if num_homography >= params.homography_ratio * num_inliers:
        return Degeneracy.HOMOGRAPHY
    if epipolar_conditioning(inliers0, inliers1) < params.min_conditioning:
        return Degeneracy.ILL_CONDITIONED
    return Degeneracy.NONE


def point_spread(points: np.ndarray) -> float:
    """Return the root mean square distance of points (N, 2) to their centroid, in their unit."""
    return float(np.sqrt(np.mean(np.sum((points - points.mean(axis=0)) ** 2, axis=1))))


def line_distance(points: np.ndarray) -> float:
    """Return the root mean square distance of points (N, 2) to their total-least-squares line, in their unit."""
    centred = points - points.mean(axis=0)
    return float(np.linalg.svd(centred, compute_uv=False)[-1] / np.sqrt(len(points)))


def epipolar_conditioning(points0: np.ndarray, points1: np.ndarray) -> float:
    """Return the eighth over the first singular value of the Hartley-normalised epipolar equations of N >= 8 points.

    0 if more than one fundamental matrix satisfies them, about 0.1 for points well spread in space.
    """
    A = epipolar_equations(hartley_transform(points0)[0], hartley_transform(points1)[0])
    singular = np.linalg.svd(A, compute_uv=False)
    return float(singular[7] / singular[0])
