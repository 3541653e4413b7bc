"""Deviation of tracks along their epipolar lines: farther or nearer than anything static could be."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.contact import contact_excess
from moseg.tasks.rigidity.given_depth import DepthBounds
from moseg.tasks.rigidity.ground import Ground
from moseg.tasks.rigidity.parallax import Parallax
from moseg.tasks.rigidity.patch_test import UNBOUNDED, AllowedParallax

_ALLOWED = 1.5  # shares of noise of the ground's or the given depth within which a point may still be static
_ROUNDING = 1.0, 0.5  # px; added to the least and largest parallax of a static point


class Deviation(NamedTuple):
    """Deviation of N tracks along their epipolar lines from what a static point may do; float64 (N,) each.

    Attributes
    ----------
    too_far : px; how much less its parallax is than that of the farthest static point.
    far_noise : px; its standard deviation.
    too_near : standard deviations; how much more it is than that of the nearest static point.
    allowed : AllowedParallax
        Of static points.
    """

    too_far: np.ndarray
    far_noise: np.ndarray
    too_near: np.ndarray
    allowed: AllowedParallax


def deviation_from_ground(
    points: np.ndarray,
    parallax: Parallax,
    ground: Ground | None,
    shape: tuple[int, int],
    noise: np.ndarray,
    params: RigidityParams,
) -> Deviation:
    """Return the deviation from points in front of the ground that stand on it; without it, from points at any depth.

    Parameters
    ----------
    points : float64 (N, 2)
        xy of the tracks in frame 0, px.
    parallax : Parallax
        Of these tracks.
    ground : Ground or None
    shape : (height, width)
        Of the frame.
    noise : float64 (N,)
        Of their displacements, px.
    params : RigidityParams
    """
    behind_infinity = np.maximum(-parallax.along, 0)
    if ground is None:
        nothing, anything = np.zeros(len(points)), np.full(len(points), UNBOUNDED)
        return Deviation(behind_infinity, noise, nothing, AllowedParallax(nothing, anything))
    on_ground = parallax.at(np.maximum(ground.inverse_depth(points), 0))
    too_far = np.maximum(behind_infinity, on_ground - parallax.along)
    far_noise = np.hypot(noise, params.ground_slack * on_ground)
    least = np.maximum(on_ground * (1 - _ALLOWED * params.ground_slack) - _ROUNDING[0], 0)
    too_near, height = contact_excess(points, parallax, ground, shape, noise, params)
    # A static surface with its foot as far above the ground as needs no motion.
    standing = parallax.inverse_depth * (1 - height) / (1 - params.contact_lift)
    largest = np.where(too_near > 0, parallax.at(standing) + _ROUNDING[1], UNBOUNDED)
    return Deviation(too_far, far_noise, too_near, AllowedParallax(least, largest))


def deviation_from_depth(
    parallax: Parallax, bounds: DepthBounds, noise: np.ndarray, params: RigidityParams
) -> Deviation:
    """Return the deviation from points at given depths.

    Parameters
    ----------
    parallax : Parallax
        Of N tracks.
    bounds : DepthBounds
        Of these tracks.
    noise : float64 (N,)
        Of their displacements, px.
    params : RigidityParams
    """
    is_known = np.isfinite(bounds.nearest)
    parallaxes = (parallax.at(np.where(is_known, np.maximum(each, 0), 0)) for each in bounds)
    farthest, nearest = (np.minimum(each, UNBOUNDED) for each in parallaxes)
    nearest = np.where(is_known, nearest, UNBOUNDED)
    too_far = np.maximum(farthest - parallax.along, 0)
    far_noise = np.hypot(noise, params.depth_noise * farthest)
    too_near = np.maximum(parallax.along - nearest, 0) / np.hypot(noise, params.depth_noise * nearest)
    slack = _ALLOWED * params.depth_noise
    least = np.maximum(farthest * (1 - slack) - _ROUNDING[0], 0)
    return Deviation(too_far, far_noise, too_near, AllowedParallax(least, nearest * (1 + slack) + _ROUNDING[1]))
