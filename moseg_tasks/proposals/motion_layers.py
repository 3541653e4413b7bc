"""Two affine motions in one component, fitted to samples of its velocity."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.saliency.grid import vector_length

CAP = 4.0
"""Residual, in units of noise, at which the cost of a sample is truncated."""
_MIN_SAMPLES = 6  # samples to which an affine motion is fitted


class VelocitySamples(NamedTuple):
    """Motion of N pixels of a component in one frame, relative to the background.

    Attributes
    ----------
    design : float64 (N, 3)
        1, x, y; px from the component's centroid, so that frames can be compared.
    velocity : float64 (N, 2)
        px/frame; the mean of both time directions.
    weight : float64 (N,)
        0..1, low where both directions differ, because one of them is occluded there.
    centre : float64 (2,)
        The centroid, xy, px.
    noise : float
        Standard deviation of the noise, px/frame.
    """

    design: np.ndarray
    velocity: np.ndarray
    weight: np.ndarray
    centre: np.ndarray
    noise: float


def sample_velocity(mask: np.ndarray, residual_flows: np.ndarray, step: int, params: IdentityParams) -> VelocitySamples:
    """Sample the velocity of one frame on a grid of `step` px.

    Parameters
    ----------
    mask : bool (y, x)
        The component.
    residual_flows : float32 (2, y, x, 2)
        Flow to the previous and the next frame less the background's, px/frame; zeros where there is no such frame.
    step : int
    params : IdentityParams
    """
    thinned = mask[::step, ::step]
    y, x = np.nonzero(thinned)
    backward, forward = (flow[::step, ::step][thinned].astype(np.float64) for flow in residual_flows)
    if not backward.any():
        backward = -forward
    elif not forward.any():
        forward = -backward
    velocity = (forward - backward) / 2
    speed = float(np.median(vector_length(velocity))) if len(velocity) else 0.0
    noise = params.split_noise + params.split_noise_motion * speed
    weight = 1 / (1 + (vector_length(forward + backward) / (2 * noise)) ** 2)
    position = np.column_stack([x, y]) * float(step)
    centre = position.mean(axis=0) if len(x) else np.zeros(2)
    design = np.column_stack([np.ones(len(x)), position - centre])
    return VelocitySamples(design, velocity, weight, centre, noise)


def fit_motion(samples: VelocitySamples, among: np.ndarray, params: IdentityParams) -> np.ndarray:
    """Fit the affine motion float64 (3, 2), rows 1, x, y, that most of the samples `among` (bool (N,)) follow.

    Least squares reweighted by Cauchy's function; the slopes are regularised to 0, more so for a small extent.
    """
    design, velocity, weight = samples.design[among], samples.velocity[among], samples.weight[among]
    origin = weight @ design / max(weight.sum(), 1e-9)
    local = design - origin * [0, 1, 1]
    motion = np.vstack([np.median(velocity, axis=0), np.zeros((2, 2))])
    for _ in range(params.split_iterations):
        robust = weight / (1 + (vector_length(local @ motion - velocity) / samples.noise) ** 2)
        weighted = local * robust[:, None]
        normal = weighted.T @ local + np.diag([1e-9, *[robust.sum() * params.split_stiffness**2 + 1e-9] * 2])
        motion = np.linalg.solve(normal, weighted.T @ velocity)
    motion[0] -= origin[1:] @ motion[1:]
    return motion


def residuals(samples: VelocitySamples, motion: np.ndarray) -> np.ndarray:
    """Return each sample's deviation from an affine motion, float64 (N,) px/frame."""
    return vector_length(samples.design @ motion - samples.velocity)


class TwoMotions(NamedTuple):
    """Two affine motions float64 (3, 2) of a frame, and the samples that follow the second, bool (N,)."""

    first: np.ndarray
    second: np.ndarray
    is_second: np.ndarray


def cut_motions(samples: VelocitySamples, params: IdentityParams) -> TwoMotions:
    """Fit two motions to the halves of a cut across the axis of largest variation of the velocities."""
    return _alternate(samples, np.zeros((3, 2)), np.zeros((3, 2)), _cut(samples), np.zeros(len(samples.weight)), params)


def carry_motions(
    samples: VelocitySamples, before: TwoMotions, samples_before: VelocitySamples, params: IdentityParams
) -> TwoMotions:
    """Fit the two motions of a neighbouring frame to this one.

    Two initialisations are tried, and the one with the better fit is taken: each sample follows the motion of the
    sample that was nearest, or the motion that fits its velocity. The first keeps a limb and its body apart while the
    limb turns back; the second recovers what moves fast or was hidden. In all iterations a sample changes its motion
    only if that improves its residual by more than the noise.
    """
    # Relative to the centroid, a sample usually moves by less than a step between frames.
    _, nearest = cKDTree(samples_before.design[:, 1:]).query(samples.design[:, 1:])
    stayed = before.is_second[nearest]
    stay = np.where(stayed, -samples.noise, samples.noise)
    starts = (stayed, _is_second(samples, before.first, before.second, stay))
    ends = [_alternate(samples, before.first, before.second, start, stay, params) for start in starts]
    return min(ends, key=lambda motions: mean_residual(samples, own_residuals(samples, motions)))


def mean_residual(samples: VelocitySamples, residuals: np.ndarray) -> float:
    """Return the mean squared residual in units of noise, truncated at `CAP`."""
    return float(samples.weight @ np.minimum(residuals / samples.noise, CAP) ** 2 / samples.weight.sum())


def own_residuals(samples: VelocitySamples, motions: TwoMotions) -> np.ndarray:
    """Return each sample's deviation from the motion that it follows, float64 (N,) px/frame."""
    return np.where(motions.is_second, residuals(samples, motions.second), residuals(samples, motions.first))


def _alternate(
    samples: VelocitySamples,
    first: np.ndarray,
    second: np.ndarray,
    is_second: np.ndarray,
    stay: np.ndarray,
    params: IdentityParams,
) -> TwoMotions:
    """Fit and assign in turn. A motion that too few samples follow remains unchanged."""
    motions = [first, second]
    for _ in range(params.split_iterations):
        for index, among in enumerate((~is_second, is_second)):
            if among.sum() >= _MIN_SAMPLES:
                motions[index] = fit_motion(samples, among, params)
        before, is_second = is_second, _is_second(samples, *motions, stay)
        if (before == is_second).all():
            break
    return TwoMotions(*motions, is_second)


def _is_second(samples: VelocitySamples, first: np.ndarray, second: np.ndarray, stay: np.ndarray) -> np.ndarray:
    return residuals(samples, second) + stay < residuals(samples, first)


def _cut(samples: VelocitySamples) -> np.ndarray:
    """Return Otsu's cut of the velocities along their principal axis, bool (N,)."""
    weight = samples.weight / samples.weight.sum()
    centred = samples.velocity - weight @ samples.velocity
    _, axes = np.linalg.eigh((centred * weight[:, None]).T @ centred)
    along = centred @ axes[:, 1]
    order = np.argsort(along, kind="stable")
    below = np.cumsum(weight[order])
    gained = np.cumsum((weight * along)[order]) ** 2 / np.maximum(below * (1 - below), 1e-9)
    return along > along[order[int(np.argmax(gained[:-1]))]]
