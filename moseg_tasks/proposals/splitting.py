"""Splitting of components into objects that touch in the image but move apart."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from scipy import ndimage

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.proposals.motion_layers import (
    CAP,
    TwoMotions,
    VelocitySamples,
    carry_motions,
    cut_motions,
    fit_motion,
    mean_residual,
    own_residuals,
    residuals,
    sample_velocity,
)

_MIN_SAMPLES = 12


class _Layers(NamedTuple):
    """Two motions in one frame of a component and the evidence that both are there."""

    motions: tuple[np.ndarray, np.ndarray]
    areas: tuple[float, float]  # px
    relative: np.ndarray  # of the second to the first at the smaller part, px/frame
    separation: float  # its length in mean deviations
    explained: float  # share of a single motion's residual


def split_touching(labels: np.ndarray, residual_flows: np.ndarray, params: IdentityParams, gap: int = 1) -> np.ndarray:
    """Split components of two or more motions that belong to different objects.

    A component is two objects if in several frames two affine motions explain it and one does not, each motion has a
    compact part, the motions differ far more than each part varies, and the sum of their differences over time
    separates the parts. Limbs fail the last two conditions: they are connected to the body and swing back.

    Parameters
    ----------
    labels : uint16 or int32 (T, h, w)
        Component of each pixel of the working grid; 0 = background.
    residual_flows : float32 (T, 2, h, w, 2)
        Flow to the previous and to the next frame less the background's, px; zeros where there is no such frame.
    params : IdentityParams
    gap : int, optional
        Pictures from a frame to those that the flow leads to.

    Returns
    -------
    labels : as `labels`
        The larger part of a split component keeps its label; others get new labels above all existing ones.

    Raises
    ------
    InputError
        The flows are not those of the labels.
    """
    if residual_flows.shape != (len(labels), 2, *labels.shape[1:], 2):
        expected = (len(labels), 2, *labels.shape[1:], 2)
        raise InputError("flows are not those of the labels", got=residual_flows.shape, expected=expected)
    result = labels.copy()
    newest = int(labels.max(initial=0))
    for label, box in enumerate(ndimage.find_objects(labels.astype(np.int32)), start=1):
        waiting, parts = [label] * (box is not None), 1
        while waiting and parts < params.split_parts:
            current = waiting.pop()
            moved = residual_flows[box[0], :, box[1], box[2]]
            second = _second_object(result[box] == current, moved, labels, params, gap)
            if second is not None:
                newest, parts = newest + 1, parts + 1
                result[box][second] = newest
                waiting += [current, newest]
    return result


def _second_object(
    component: np.ndarray, residual_flows: np.ndarray, labels: np.ndarray, params: IdentityParams, gap: int
) -> np.ndarray | None:
    """Return the smaller of a component's two objects, bool (T, h, w); None where it is one."""
    areas = component.sum(axis=(1, 2))
    min_area = params.min_area * labels.shape[1] * labels.shape[2]
    if (areas >= 2 * min_area).sum() < params.split_frames:
        return None
    usual_area = areas.sum() / (areas > 0).sum()
    step = max(1, round(float(np.sqrt(usual_area / params.split_samples))))
    frames = zip(component, residual_flows, strict=True)
    samples = [sample_velocity(mask, flows, step, params) for mask, flows in frames]
    singles = [_residual_of_one(frame, params) for frame in samples]
    broken = [t for t, (_, share) in enumerate(singles) if share > params.split_outliers]
    if len(broken) < params.split_frames:
        return None
    layers = _follow_layers(samples, [residual for residual, _ in singles], broken, step, params)
    if not _is_apart([layer for layer in layers if layer is not None and min(layer.areas) >= min_area], params, gap):
        return None
    second = np.zeros(component.shape, bool)
    for t, layer in enumerate(layers):
        if layer is not None:
            second[t] = _assign(component[t], residual_flows[t], layer, samples[t], min_area, params)
    first = component & ~second
    seen = (second.sum(axis=(1, 2)) >= min_area) & (first.sum(axis=(1, 2)) >= min_area)
    if seen.sum() < params.split_frames:
        return None
    if min(_compactness(second[seen]), _compactness(first[seen])) < params.split_compactness:
        return None
    return second if second.sum() <= first.sum() else first


def _residual_of_one(samples: VelocitySamples, params: IdentityParams) -> tuple[float, float]:
    """Return the mean residual of a single motion, and the share of the samples that it leaves unexplained."""
    if len(samples.weight) < _MIN_SAMPLES:
        return 0.0, 0.0
    apart = residuals(samples, fit_motion(samples, np.ones(len(samples.weight), bool), params))
    outliers = samples.weight @ (apart > 2 * samples.noise)
    return mean_residual(samples, apart), float(outliers / samples.weight.sum())


def _follow_layers(
    samples: Sequence[VelocitySamples],
    singles: Sequence[float],
    broken: Sequence[int],
    step: int,
    params: IdentityParams,
) -> list[_Layers | None]:
    """Fit both motions in every frame, forwards and backwards in time from the frame that shows them best.

    Empty if no frame shows them far enough apart.
    """
    tried = broken[:: -(-len(broken) // params.split_starts)]
    found = {t: cut_motions(samples[t], params) for t in tried}
    weighed = {t: _weigh(samples[t], motions, singles[t], step) for t, motions in found.items()}
    if max(layer.separation for layer in weighed.values()) < params.split_separation:
        return []
    start = max(tried, key=lambda t: weighed[t].explained)
    layers: list[_Layers | None] = [None] * len(samples)
    layers[start] = weighed[start]
    for order in (range(start + 1, len(samples)), range(start - 1, -1, -1)):
        last = start
        motions = found[start]
        for t in order:
            if len(samples[t].weight) >= _MIN_SAMPLES:
                motions = carry_motions(samples[t], motions, samples[last], params)
                layers[t] = _weigh(samples[t], motions, singles[t], step)
                last = t
    return layers


def _weigh(samples: VelocitySamples, motions: TwoMotions, single: float, step: int) -> _Layers:
    """Measure how much two motions reduce the mean residual `single` of one motion, and how far they are apart."""
    first, second, is_second = motions
    apart = own_residuals(samples, motions)
    counts = np.array([(~is_second).sum(), is_second.sum()])
    smaller = is_second if counts[1] < counts[0] else ~is_second
    # Difference of the motions at the smaller part, where the parts would be connected.
    place = samples.design[smaller].mean(axis=0) if smaller.any() else np.array([1.0, 0.0, 0.0])
    relative = place @ (second - first)
    spread = max(float(samples.weight @ apart / samples.weight.sum()), 1e-6)
    areas = tuple((counts * step**2).tolist())
    explained = 1 - mean_residual(samples, apart) / max(single, 1e-9)
    return _Layers((first, second), areas, relative, float(np.hypot(*relative)) / spread, explained)


def _is_apart(seen: Sequence[_Layers], params: IdentityParams, gap: int) -> bool:
    """Check whether the motions of the frames in which both are seen are of two objects."""
    if len(seen) < params.split_frames:
        return False
    size = np.sqrt(np.median([min(layer.areas) for layer in seen]))
    travel = np.hypot(*np.sum([layer.relative for layer in seen], axis=0)) / gap
    return bool(
        np.median([layer.explained for layer in seen]) >= params.split_explained
        and np.median([layer.separation for layer in seen]) >= params.split_separation
        and travel >= params.split_travel * size
    )


def _assign(
    component: np.ndarray,
    residual_flows: np.ndarray,
    layer: _Layers,
    samples: VelocitySamples,
    min_area: float,
    params: IdentityParams,
) -> np.ndarray:
    """Return the pixels bool (h, w) of a frame's component that follow the second motion."""
    y, x = np.nonzero(component)
    design = np.column_stack([np.ones(len(x)), x - samples.centre[0], y - samples.centre[1]])
    velocities = [sign * flow[y, x] for sign, flow in zip((-1, 1), residual_flows, strict=True) if flow.any()]
    deviations = []
    for motion in layer.motions:
        # Next to an occlusion a pixel's flow is right in one time direction only.
        apart = [np.linalg.norm(design @ motion - velocity, axis=1) for velocity in velocities]
        deviations.append(np.minimum.reduce(apart, initial=CAP * samples.noise, axis=0))
    votes = np.zeros(component.shape, np.float32)
    votes[y, x] = deviations[0] - deviations[1]
    votes = cv2.blur(votes, (params.split_blur, params.split_blur), borderType=cv2.BORDER_CONSTANT)
    second = component & (votes > 0)
    # Specks belong to their surroundings.
    second = _without_specks(second, min_area)
    return component & ~_without_specks(component & ~second, min_area)


def _without_specks(mask: np.ndarray, min_area: float) -> np.ndarray:
    _, parts, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    large = stats[:, cv2.CC_STAT_AREA] >= min_area
    large[0] = False
    return large[parts]


def _compactness(masks: np.ndarray) -> float:
    """Return the median over the frames of the share of a mask in its largest connected part."""
    shares = []
    for mask in masks:
        _, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
        shares.append(stats[1:, cv2.CC_STAT_AREA].max() / mask.sum())
    return float(np.median(shares))
