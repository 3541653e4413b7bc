"""Evidence of one frame pair against a rigid scene: how far each track deviates from every static point."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.deviation import deviation_from_depth, deviation_from_ground
from moseg.tasks.rigidity.given_depth import bound_inverse_depth, scale_inverse_depth
from moseg.tasks.rigidity.ground import Ground, fit_ground
from moseg.tasks.rigidity.neighbours import find_similar
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import find_epipole, split_displacements
from moseg.tasks.rigidity.patch_test import compare_patches
from moseg.tasks.roundness import roundness

_STRAIGHT_SIDE = 15
"""Side of the patches that are asked whether they show but a straight edge, px."""


class PairEvidence(NamedTuple):
    """Evidence of the N tracks seen in both frames of a pair.

    Attributes
    ----------
    error : float64 (N,)
        Deviation from the nearest static point in standard deviations, no more than the patch test lets stand.
    median_error : float64 (N,)
        The same of the medians over similar neighbours.
    test, strict_test : float64 (N,)
        Result of the patch test, for one rigid surface in a patch and for two, averaged over similar neighbours; 0
        where nothing was tested, and on straight edges.
    strict_error : float64 (N,)
        `median_error`, no more than the test for two surfaces lets stand.
    motion : CameraMotion
    ground : Ground or None
    """

    error: np.ndarray
    median_error: np.ndarray
    test: np.ndarray
    strict_error: np.ndarray
    strict_test: np.ndarray
    motion: CameraMotion
    ground: Ground | None


def pair_evidence(
    images: tuple[np.ndarray, np.ndarray],
    points0: np.ndarray,
    points1: np.ndarray,
    motion: CameraMotion,
    params: RigidityParams,
    inverse_depth: np.ndarray | None = None,
    length: float | None = None,
    others: Sequence[np.ndarray] = (),
) -> PairEvidence:
    """Measure the deviation of tracks from a rigid scene over one pair of frames.

    Parameters
    ----------
    images : two uint8 (y, x)
        Blurred grey frames.
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px.
    motion : CameraMotion
    params : RigidityParams
    inverse_depth : float32 (y, x), optional
        Relative inverse depth of the first frame, up to scale and shift; takes the place of the ground if it explains
        the parallax.
    length : float, optional
        How far the camera travels, in the unit of the depth, if that is known.
    others : sequence of uint8 (y, x), optional
        Blurred grey frames from well before and well after the pair, to tell what stands still for longer.

    Returns
    -------
    PairEvidence
    """
    shape = images[0].shape
    parallax = split_displacements(points0, points1, motion, shape)
    noise = displacement_noise(points0, points1, params.noise, params.noise_share)
    ground = fit_ground(points0, parallax, find_epipole(motion, shape), shape, params)
    bounds = None
    if length is not None:
        bounds = scale_inverse_depth(inverse_depth, length, points0, parallax, noise, params)
    if bounds is None and inverse_depth is not None:
        bounds = bound_inverse_depth(inverse_depth, points0, parallax, noise, params)
    if bounds is None:
        deviation = deviation_from_ground(points0, parallax, ground, shape, noise, params)
    else:
        deviation = deviation_from_depth(parallax, bounds, noise, params)
    far = deviation.too_far / deviation.far_noise
    squared = (parallax.across / noise) ** 2 + far**2 + deviation.too_near**2
    similar = find_similar(points0, points1, params)
    across = similar.median(parallax.across)
    across /= displacement_noise(points0, points1, params.median_noise, params.median_noise_share)
    median_squared = across**2 + similar.median(far) ** 2 + similar.median(deviation.too_near) ** 2
    doubtful = np.flatnonzero((squared > params.test_above) | (median_squared > params.test_above))
    # A marking along the road looks alike wherever the tracker is on it, but is wider where it is nearer.
    doubtful = doubtful[roundness(images[0], points0[doubtful], _STRAIGHT_SIDE) >= params.test_roundness]
    tests = np.zeros((len(points0), 2))
    allowed = deviation.allowed
    tests[doubtful] = compare_patches(*images, points0, points1, parallax, allowed, doubtful, params, others)
    test, strict_test = (similar.mean_with_itself(each) for each in tests.T)

    def limited(squared, test):
        return np.sqrt(np.minimum(squared, params.test_gain * np.maximum(test, 0)))

    return PairEvidence(
        error=limited(squared, test),
        median_error=limited(median_squared, test),
        test=test,
        strict_error=limited(median_squared, strict_test),
        strict_test=strict_test,
        motion=motion,
        ground=ground,
    )
