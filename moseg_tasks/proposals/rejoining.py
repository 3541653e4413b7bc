"""Re-identification of objects after an occlusion."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from scipy import ndimage
from scipy.optimize import linear_sum_assignment

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.saliency.consistency import NEXT, PREVIOUS

_LAB_BINS = (8, 32, 32)
_LAB_RANGES = (0, 256) * 3


class Sight(NamedTuple):
    """A component's frames, and its appearance where it is fully visible, near the end to be continued.

    Attributes
    ----------
    first, last : int
        Its frames.
    frame : int
        Frame of the `centre`, the one next to that end in which it is fully visible.
    centre : float64 (2,)
        xy, px of the working grid.
    velocity : float64 (2,)
        Relative to the background, px/frame.
    area : float
        Px.
    histogram : float32 (8, 32, 32)
        Shares of CIELAB colours.
    """

    first: int
    last: int
    frame: int
    centre: np.ndarray
    velocity: np.ndarray
    area: float
    histogram: np.ndarray


def rejoin_components(
    labels: np.ndarray, images: np.ndarray, flows: np.ndarray, residual_flows: np.ndarray, params: IdentityParams
) -> np.ndarray:
    """Give a component that begins where another's motion leads it the other's label.

    The other ended some frames before, not at the frame's border. While it is hidden it is predicted to move with the
    background plus its own velocity relative to the background. Position, velocity, area and colours must agree; of
    several continuations the best one-to-one assignment is taken. All measurements are of fully visible frames.

    Parameters
    ----------
    labels : uint16 or int32 (T, h, w)
        Component of each pixel of the working grid; 0 = background.
    images : uint8 (T, h, w, 3)
        RGB.
    flows : float32 (T, 2, h, w, 2)
        Flow to the previous and to the next frame, px/frame; zeros where there is no such frame.
    residual_flows : float32 (T, 2, h, w, 2)
        The same less the background's.
    params : IdentityParams

    Returns
    -------
    labels : as `labels`
        A rejoined component has the label of its earliest part; labels no longer in use leave gaps.

    Raises
    ------
    InputError
        Images or flows are not those of the labels.
    """
    size = labels.shape
    for where, array, expected in (
        ("images", images, (*size, 3)),
        ("flows", flows, (size[0], 2, *size[1:], 2)),
        ("residual flows", residual_flows, (size[0], 2, *size[1:], 2)),
    ):
        if array.shape != expected:
            raise InputError("not of the labels' frames", where=where, got=array.shape, expected=expected)
    boxes = ndimage.find_objects(labels.astype(np.int32))
    lasting = [
        label
        for label, box in enumerate(boxes, start=1)
        if box is not None and box[0].stop - box[0].start >= params.rejoin_frames
    ]
    spans = {label: (boxes[label - 1][0].start, boxes[label - 1][0].stop - 1) for label in lasting}
    ends = [label for label in lasting if _is_inside(labels, label, spans[label][1])]
    begins = [label for label in lasting if _is_inside(labels, label, spans[label][0])]
    # Such pairs are rare: only their components are described.
    pairs = [(i, j) for i in ends for j in begins if i != j and is_in_time(spans[i], spans[j], params)]
    before = {i: look(labels, images, residual_flows, i, boxes[i - 1], True, params) for i in {i for i, _ in pairs}}
    after = {j: look(labels, images, residual_flows, j, boxes[j - 1], False, params) for j in {j for _, j in pairs}}
    gains = np.zeros((len(boxes) + 1,) * 2)
    for i, j in pairs:
        if after[j].frame > before[i].frame:
            predicted = _predict(before[i], after[j], flows, residual_flows)
            gains[i, j] = agreement(before[i], after[j], predicted, labels[0].size, params)
    return rename(gains, spans)[labels].astype(labels.dtype)


def rename(gains: np.ndarray, spans: dict[int, tuple[int, int]]) -> np.ndarray:
    """Return the new label of each label, int64 (label,), from the gains (earlier, later) of joining two."""
    renamed = np.arange(len(gains))
    found = [(i, j) for i, j in zip(*linear_sum_assignment(gains, maximize=True), strict=True) if gains[i, j] > 0]
    # In order of time, so that a third part gets the first one's label.
    for i, j in sorted(found, key=lambda pair: spans[pair[1]]):
        renamed[j] = renamed[i]
    return renamed


def renumber(identity: np.ndarray, renamed: np.ndarray) -> np.ndarray:
    """Return identities, an array of any shape, by their new names, int64 (identity,), numbered without gaps."""
    _, compact = np.unique(renamed, return_inverse=True)
    return compact.astype(identity.dtype)[identity]


def _is_inside(labels: np.ndarray, label: int, frame: int) -> bool:
    """Check that a component touches neither the frame's border nor the section's first or last frame."""
    if frame in (0, len(labels) - 1):
        return False
    image = labels[frame]
    return not any((side == label).any() for side in (image[0], image[-1], image[:, 0], image[:, -1]))


def is_in_time(span0: tuple[int, int], span1: tuple[int, int], params: IdentityParams) -> bool:
    """Check whether one span may continue the other: later at both ends, and within the gap allowed."""
    later = span1[0] > span0[0] and span1[1] > span0[1]
    return later and abs(span1[0] - span0[1] - 1) <= params.rejoin_gap


def look(
    labels: np.ndarray,
    images: np.ndarray,
    residual_flows: np.ndarray,
    label: int,
    box: Sequence[slice],
    is_end: bool,
    params: IdentityParams,
) -> Sight:
    """Describe a component shortly before it ends, or after it began."""
    masks = labels[tuple(box)] == label
    areas = masks.sum(axis=(1, 2))
    usual = float(np.percentile(areas[areas > 0], 75))
    seen = np.flatnonzero(areas >= params.rejoin_seen * usual)
    seen = seen[::-1][: params.rejoin_memory] if is_end else seen[: params.rejoin_memory]
    histogram, velocities = np.zeros(_LAB_BINS, np.float32), []
    for t in seen:
        frame, rows, columns = box[0].start + t, box[1], box[2]
        forward, backward = (residual_flows[frame, d, rows, columns][masks[t]] for d in (NEXT, PREVIOUS))
        velocities += [sign * np.median(v, axis=0) for sign, v in ((1, forward), (-1, backward)) if v.any()]
        lab = cv2.cvtColor(images[frame, rows, columns], cv2.COLOR_RGB2LAB)
        histogram += cv2.calcHist([lab], [0, 1, 2], masks[t].astype(np.uint8), _LAB_BINS, _LAB_RANGES)
    y, x = np.nonzero(masks[seen[0]])
    return Sight(
        first=box[0].start,
        last=box[0].stop - 1,
        frame=box[0].start + int(seen[0]),
        centre=np.array([x.mean() + box[2].start, y.mean() + box[1].start]),
        velocity=np.median(velocities, axis=0) if velocities else np.zeros(2),
        area=usual,
        histogram=_normalised(histogram),
    )


def _normalised(histogram: np.ndarray) -> np.ndarray:
    # Neighbouring bins are mixed, because the illumination changes slightly.
    smooth = ndimage.gaussian_filter(histogram, 0.7, mode="nearest")
    return smooth / max(float(smooth.sum()), 1e-9)


def agreement(before: Sight, after: Sight, predicted: np.ndarray, frame_area: int, params: IdentityParams) -> float:
    """Return how well one component continues the other, whose `predicted` place is xy, px; 0..2, 0 where it cannot."""
    if after.frame <= before.frame or min(before.area, after.area) < params.min_area * frame_area:
        return 0.0
    if max(before.area, after.area) > params.rejoin_growth * min(before.area, after.area):
        return 0.0
    speed = max(np.hypot(*before.velocity), np.hypot(*after.velocity))
    if np.hypot(*(after.velocity - before.velocity)) > params.rejoin_turn * speed + params.rejoin_drift:
        return 0.0
    similarity = float(np.sqrt(before.histogram * after.histogram).sum())
    way = np.hypot(*(before.velocity + after.velocity)) / 2 * (after.frame - before.frame)
    reach = params.rejoin_reach * np.sqrt(min(before.area, after.area)) + params.rejoin_stray * way
    away = np.hypot(*(after.centre - predicted)) / reach
    return 1 - away + similarity if away < 1 and similarity >= params.rejoin_colour else 0.0


def _predict(before: Sight, after: Sight, flows: np.ndarray, residual_flows: np.ndarray) -> np.ndarray:
    """Predict where xy an object reappears, moved by the background and its own mean velocity."""
    place = before.centre.copy()
    height, width = flows.shape[2:4]
    for frame in range(before.frame, after.frame):
        x, y = np.clip(np.rint(place).astype(int), 0, [width - 1, height - 1])
        background = flows[frame, NEXT, y, x] - residual_flows[frame, NEXT, y, x]
        place += background + (before.velocity + after.velocity) / 2
    return place
