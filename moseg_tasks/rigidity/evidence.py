"""Evidence of one frame pair against a rigid scene: how far each track deviates from every static point."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.contact import contact_excess
from moseg.tasks.rigidity.ground import Ground, fit_ground
from moseg.tasks.rigidity.neighbours import find_similar
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import Parallax, find_epipole, split_displacements
from moseg.tasks.rigidity.patch_test import AllowedParallax, compare_patches
from moseg.tasks.rigidity.relative_pose import fit_pose
from moseg.tasks.saliency.camera import CameraMotion

_ANY = 1e4  # px; a parallax that no track has
_BELOW_GROUND = 1.5  # slacks of the ground within which a rigid point may still lie below it
_ROUNDING = 1.0, 0.5  # px; added to the least and largest parallax of a rigid point


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


class PairEvidence(NamedTuple):
    """Evidence of the N tracks seen in both frames of a pair.

    Attributes
    ----------
    error : float64 (N,)
        Deviation from the nearest static point in standard deviations, no more than the patch test lets stand.
    median_error : float64 (N,)
        The same of the medians over similar neighbours.
    test : float64 (N,)
        Result of the patch test, averaged over similar neighbours; 0 where nothing was tested.
    motion : CameraMotion
    ground : Ground or None
    """

    error: np.ndarray
    median_error: np.ndarray
    test: np.ndarray
    motion: CameraMotion
    ground: Ground | None


def pair_evidence(
    images: tuple[np.ndarray, np.ndarray],
    points0: np.ndarray,
    points1: np.ndarray,
    focal: float,
    params: RigidityParams,
) -> PairEvidence | None:
    """Measure the deviation of tracks from a rigid scene over one pair of frames.

    Parameters
    ----------
    images : two uint8 (y, x)
        Blurred grey frames.
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px.
    focal : float
        Focal length in longer sides of the frame.
    params : RigidityParams

    Returns
    -------
    PairEvidence or None
        None if no motion of the camera explains the tracks.
    """
    shape = images[0].shape
    motion = fit_pose(points0, points1, focal, shape, params)
    if motion is None:
        return None
    parallax = split_displacements(points0, points1, motion, shape)
    noise = displacement_noise(points0, points1, params.noise, params.noise_share)
    ground = fit_ground(points0, parallax, find_epipole(motion, shape), shape, params)
    deviation = deviation_from_ground(points0, parallax, ground, noise, params)
    far = deviation.too_far / deviation.far_noise
    squared = (parallax.across / noise) ** 2 + far**2 + deviation.too_near**2
    similar = find_similar(points0, points1, params)
    across = similar.median(parallax.across)
    across /= displacement_noise(points0, points1, params.median_noise, params.median_noise_share)
    median_squared = across**2 + similar.median(far) ** 2 + similar.median(deviation.too_near) ** 2
    doubtful = np.flatnonzero((squared > params.test_above) | (median_squared > params.test_above))
    test = np.zeros(len(points0))
    test[doubtful] = compare_patches(*images, points0, points1, parallax, deviation.allowed, doubtful, params)
    test = similar.mean_with_itself(test)
    limit = params.test_gain * np.maximum(test, 0)
    error, median_error = (np.sqrt(np.minimum(each, limit)) for each in (squared, median_squared))
    return PairEvidence(error, median_error, test, motion, ground)


def deviation_from_ground(
    points: np.ndarray, parallax: Parallax, ground: Ground | None, noise: np.ndarray, params: RigidityParams
) -> Deviation:
    """Return the deviation from points in front of the ground that stand on it; without it, from points at any depth.

    Parameters
    ----------
    points : float64 (N, 2)
        xy of the tracks in frame 0, px.
    parallax : Parallax
        Of these tracks.
    ground : Ground or None
    noise : float64 (N,)
        Of their displacements, px.
    params : RigidityParams
    """
    behind_infinity = np.maximum(-parallax.along, 0)
    if ground is None:
        nothing, anything = np.zeros(len(points)), np.full(len(points), _ANY)
        return Deviation(behind_infinity, noise, nothing, AllowedParallax(nothing, anything))
    on_ground = parallax.at(np.maximum(ground.inverse_depth(points), 0))
    too_far = np.maximum(behind_infinity, on_ground - parallax.along)
    far_noise = np.hypot(noise, params.ground_slack * on_ground)
    least = np.maximum(on_ground * (1 - _BELOW_GROUND * params.ground_slack) - _ROUNDING[0], 0)
    too_near, height = contact_excess(points, parallax, ground, noise, params)
    # A static surface with its foot as far above the ground as needs no motion.
    standing = parallax.inverse_depth * (1 - height) / (1 - params.contact_lift)
    largest = np.where(too_near > 0, parallax.at(standing) + _ROUNDING[1], _ANY)
    return Deviation(too_far, far_noise, too_near, AllowedParallax(least, largest))
