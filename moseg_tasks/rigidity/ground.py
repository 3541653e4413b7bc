"""The ground under a camera that moves parallel to it: a plane whose inverse depth vanishes at the epipole's row."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.linear_fit import FitLimits, fit_two_parameters
from moseg.tasks.rigidity.parallax import Parallax


class Ground(NamedTuple):
    """A plane's inverse depth ``slope @ (point - epipole)`` in frame 0, linear in the pixel's position.

    Unlike the plane of `moseg.tasks.saliency.ground` it has two degrees of freedom, so few tracks determine it.

    Attributes
    ----------
    slope : float64 (2,)
        Inverse depth per px, in x and y.
    epipole : float64 (2,)
        In frame 0, xy, px.
    """

    slope: np.ndarray
    epipole: np.ndarray

    def inverse_depth(self, points: np.ndarray) -> np.ndarray:
        """Return the plane's inverse depth (N,) at points (N, 2), xy, px of frame 0; negative above the horizon."""
        return (points - self.epipole) @ self.slope


def fit_ground(
    points: np.ndarray, parallax: Parallax, epipole: np.ndarray | None, shape: tuple[int, int], params: RigidityParams
) -> Ground | None:
    """Fit the plane of most tracks of the frame's lower part, by RANSAC and Tukey's biweight on its parallax.

    Parameters
    ----------
    points : float64 (N, 2)
        xy of the tracks in frame 0, px.
    parallax : Parallax
        Of these tracks.
    epipole : float64 (2,) or None
        In frame 0, xy, px (`find_epipole`).
    shape : (height, width)
    params : RigidityParams

    Returns
    -------
    Ground or None
        None if the camera does not travel towards or away from what it sees, or too few tracks lie on one plane that
        is nearer at the bottom.
    """
    height, width = shape
    if epipole is None or not (0 < epipole[0] < width and 0 < epipole[1] < height):
        return None
    top = max(params.ground_top * height, epipole[1] + params.ground_below_epipole)
    low = (points[:, 1] > top) & np.isfinite(parallax.inverse_depth)
    if np.count_nonzero(low) < params.ground_points:
        return None
    design, values, weights = points[low] - epipole, parallax.inverse_depth[low], parallax.reach[low]
    tolerance = np.hypot(params.ground_tolerance, params.ground_relief * values * weights)
    limits = FitLimits(
        params.ground_samples,
        params.ground_refined,
        params.ground_iterations,
        params.ground_points,
        params.ground_share,
    )
    rng = np.random.default_rng(params.seed)

    def is_ground(slopes):
        """Return whether planes (..., 2) are nearer at the bottom, and about level."""
        return (slopes[..., 1] > 0) & (np.abs(slopes[..., 0]) < params.ground_tilt * np.abs(slopes[..., 1]))

    slope = fit_two_parameters(design, values, weights, tolerance, is_ground, limits, rng)
    return None if slope is None else Ground(slope, epipole)
