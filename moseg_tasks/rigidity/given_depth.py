"""Inverse depth of tracks from a given map, in the unit of their parallax."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.linear_fit import FitLimits, fit_two_parameters
from moseg.tasks.rigidity.parallax import Parallax


class DepthBounds(NamedTuple):
    """Inverse depths between which each of N tracks lies by a given map; float64 (N,), -inf and inf where unknown."""

    farthest: np.ndarray
    nearest: np.ndarray


def bound_inverse_depth(
    inverse_depth: np.ndarray, points: np.ndarray, parallax: Parallax, noise: np.ndarray, params: RigidityParams
) -> DepthBounds | None:
    """Fit scale and shift of a map to the parallax of most tracks and return the depths that it gives to each.

    The bounds are the extremes within `params.depth_reach` px, because outlines of maps lie beside those of frames.

    Parameters
    ----------
    inverse_depth : float32 (y, x)
        Relative, growing towards the camera; not finite where unknown.
    points : float64 (N, 2)
        xy of the tracks, px.
    parallax : Parallax
        Of these tracks.
    noise : float64 (N,)
        Of their displacements, px.
    params : RigidityParams

    Returns
    -------
    DepthBounds or None
        None if no scale and shift explain the parallax of enough tracks.
    """
    known = np.isfinite(inverse_depth)
    # The fit has the terms 1 and the value, which are best of one size.
    scale = np.max(np.abs(inverse_depth), where=known, initial=0) or 1
    values = (inverse_depth / scale).astype(np.float32)
    column, row = np.clip(np.rint(points.T).astype(int), 0, np.array(values.shape[::-1])[:, None] - 1)
    given = values[row, column].astype(np.float64)
    used = known[row, column] & np.isfinite(parallax.inverse_depth)
    design, reach = np.column_stack([np.ones(len(given)), given])[used], parallax.reach[used]
    measured = parallax.inverse_depth[used]
    tolerance = np.hypot(2 * noise[used], params.depth_noise * measured * reach)
    limits = FitLimits(params.depth_samples, params.depth_iterations, params.depth_points, params.depth_share)
    rng = np.random.default_rng(params.seed)
    found = fit_two_parameters(design, measured, reach, tolerance, lambda found: found[..., 1] > 0, limits, rng)
    if found is None:
        return None
    side = 2 * params.depth_reach + 1
    around = np.ones((side, side), np.uint8)
    lowest = cv2.erode(np.where(known, values, np.float32(np.inf)), around)[row, column]
    highest = cv2.dilate(np.where(known, values, np.float32(-np.inf)), around)[row, column]
    is_known = known[row, column]
    farthest = np.where(is_known, found[0] + found[1] * lowest, -np.inf)
    return DepthBounds(farthest, np.where(is_known, found[0] + found[1] * highest, np.inf))
