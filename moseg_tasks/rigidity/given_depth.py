"""Inverse depth of tracks from a given map, in the unit of their parallax."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.linear_fit import FitLimits, fit_two_parameters
from moseg.tasks.rigidity.parallax import Parallax
from moseg.tasks.saliency.background import tukey_weight


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
    sampled = _sample(inverse_depth, points, params.depth_reach)
    measured, reach, tolerance = _measure(parallax, noise, params)
    used = sampled.is_known & np.isfinite(parallax.inverse_depth)
    design = np.column_stack([np.ones(len(sampled.values)), sampled.values])[used]
    limits = FitLimits(
        params.depth_samples, params.depth_refined, params.depth_iterations, params.depth_points, params.depth_share
    )
    rng = np.random.default_rng(params.seed)

    def is_nearer(found):
        return found[..., 1] > 0

    found = fit_two_parameters(design, measured[used], reach[used], tolerance[used], is_nearer, limits, rng)
    return None if found is None else sampled.bounds(*found)


def scale_inverse_depth(
    inverse_depth: np.ndarray,
    length: float,
    points: np.ndarray,
    parallax: Parallax,
    noise: np.ndarray,
    params: RigidityParams,
) -> DepthBounds | None:
    """Return the depths that a map gives to each track whose unit is known; otherwise as `bound_inverse_depth`.

    The map and the camera's translation are of one source, so nothing needs to be fitted. Where a factor near 1 makes
    more tracks agree, it is used: both are estimates.

    Parameters
    ----------
    inverse_depth : float32 (y, x)
        In the inverse of the unit of `length`.
    length : float
        Length of the camera's translation.
    points, parallax, noise, params
        As in `bound_inverse_depth`.

    Returns
    -------
    DepthBounds or None
        None if too few tracks agree with the map.
    """
    sampled = _sample(inverse_depth, points, params.depth_reach)
    given = length * sampled.factor * sampled.values
    measured, reach, tolerance = _measure(parallax, noise, params)
    used = sampled.is_known & np.isfinite(parallax.inverse_depth)
    if np.count_nonzero(used) < params.depth_points:
        return None
    given, measured, reach, tolerance = (each[used] for each in (given, measured, reach, tolerance))

    def agree(scale):
        return np.abs(scale * given - measured) * reach < tolerance

    best, scale = 1.0, 1.0
    for _ in range(params.depth_iterations):
        weight = tukey_weight((scale * given - measured) * reach, 2 * tolerance) * reach**2
        size = np.sum(weight * given**2)
        scale = np.sum(weight * given * measured) / size if size > 0 else 1.0
        scale = float(np.clip(scale, 1 / params.camera_scale, params.camera_scale))
        if agree(scale).sum() > agree(best).sum():
            best = scale
    if agree(best).mean() <= params.depth_share:
        return None
    return sampled.bounds(0.0, best * length * sampled.factor)


def sample_depth(inverse_depth: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return a map's values float64 (N,) at the pixels nearest to points (N, 2), xy, px; NaN where it has none."""
    column, row = _pixels(points, inverse_depth.shape)
    return np.where(np.isfinite(inverse_depth[row, column]), inverse_depth[row, column], np.nan).astype(np.float64)


class _Sampled(NamedTuple):
    """Values of a map at N tracks and their extremes nearby, as shares of its largest value, which is `factor`."""

    values: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray
    is_known: np.ndarray
    factor: float

    def bounds(self, shift: float, scale: float) -> DepthBounds:
        """Return the bounds under a shift and a positive scale."""
        farthest, nearest = (shift + scale * each for each in (self.lowest, self.highest))
        return DepthBounds(np.where(self.is_known, farthest, -np.inf), np.where(self.is_known, nearest, np.inf))


def _sample(inverse_depth: np.ndarray, points: np.ndarray, reach: int) -> _Sampled:
    known = np.isfinite(inverse_depth)
    # A fit has the terms 1 and the value, which are best of one size.
    factor = float(np.max(np.abs(inverse_depth), where=known, initial=0) or 1)
    values = (inverse_depth / np.float32(factor)).astype(np.float32)
    column, row = _pixels(points, values.shape)
    around = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    lowest = cv2.erode(np.where(known, values, np.float32(np.inf)), around)[row, column].astype(np.float64)
    highest = cv2.dilate(np.where(known, values, np.float32(-np.inf)), around)[row, column].astype(np.float64)
    return _Sampled(values[row, column].astype(np.float64), lowest, highest, known[row, column], factor)


def _pixels(points: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return the columns and rows, int64 (2, N), of the pixels of a map that are nearest to points (N, 2)."""
    return np.clip(np.rint(points.T).astype(int), 0, np.array(shape[::-1])[:, None] - 1)


def _measure(
    parallax: Parallax, noise: np.ndarray, params: RigidityParams
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the inverse depth that the parallax shows, its px per inverse depth, and its tolerance in px."""
    measured = parallax.inverse_depth
    return measured, parallax.reach, np.hypot(2 * noise, params.depth_noise * measured * parallax.reach)
