"""The ground under a camera that moves parallel to it: a plane whose inverse depth vanishes at the epipole's row."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.parallax import Parallax
from moseg.tasks.saliency.background import tukey_weight

_MINIMAL_SAMPLE = 2


class Ground(NamedTuple):
    """A plane's inverse depth ``slope @ (point - epipole)``, linear in the pixel's position.

    Unlike the plane of `moseg.tasks.saliency.ground` it has two degrees of freedom, so few tracks determine it.

    Attributes
    ----------
    slope : float64 (2,)
        Inverse depth per px, in x and y.
    epipole : float64 (2,)
        xy, px.
    """

    slope: np.ndarray
    epipole: np.ndarray

    def inverse_depth(self, points: np.ndarray) -> np.ndarray:
        """Return the plane's inverse depth (N,) at points (N, 2), xy, px; negative above the horizon."""
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
        xy, px.
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
    slope = _ransac_slope(design, values, weights, tolerance, params)
    if slope is None:
        return None
    for _ in range(params.ground_iterations):
        # Tracks that deviate by the tolerance still belong to an uneven ground.
        root = np.sqrt(tukey_weight((design @ slope - values) * weights, 2 * tolerance)) * weights
        slope = np.linalg.lstsq(design * root[:, None], values * root, rcond=None)[0]
    share = np.mean(np.abs(design @ slope - values) * weights < tolerance)
    return Ground(slope, epipole) if share > params.ground_share and slope[1] > 0 else None


def _ransac_slope(design, values, weights, tolerance, params: RigidityParams) -> np.ndarray | None:
    """Return the plane through a random pair of tracks that has the most tracks within the tolerance."""
    rng = np.random.default_rng(params.seed)
    pairs = rng.integers(len(values), size=(params.ground_samples, _MINIMAL_SAMPLE))
    # Pairs on a line through the epipole have no plane; their pseudo-inverse gives a plane without support.
    slopes = (np.linalg.pinv(design[pairs], rcond=1e-9) @ values[pairs][..., None])[..., 0]
    is_ground = (slopes[:, 1] > 0) & (np.abs(slopes[:, 0]) < params.ground_tilt * np.abs(slopes[:, 1]))
    error = np.abs(design @ slopes.T - values[:, None]) * weights[:, None]
    support = np.where(is_ground, np.count_nonzero(error < tolerance[:, None], axis=0), 0)
    best = np.argmax(support)
    return slopes[best] if support[best] >= params.ground_points else None
