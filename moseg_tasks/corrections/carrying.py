"""A mask of one frame, carried along the flow to other frames.

The mask is carried as the share of each cell of a coarse grid. Where flow and its reverse disagree, cells of like
colour around decide; at the outline, colours and motion of the mask against those around it. The outline at full size
follows the frame's edges.
"""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import AppearanceParams, CarryingParams, RefinementParams
from moseg.tasks.appearance import colour_bins, colour_ratio, count_sides
from moseg.tasks.corrections.own_motion import strays_from_mask
from moseg.tasks.frame_grid import frame_on_grid
from moseg.tasks.proposals.guided_filter import apply_coefficients, guided_coefficients
from moseg.tasks.saliency.grid import pixel_grid, squared_length

_MARGIN = 4  # cells around a mask that are processed, in addition to the filter's two windows
_SURE = 0.02  # share of a cell, from 0 or from 1, up to which colours do not decide
_MAX_PENALTY = 8.0  # nats
_BISECTIONS = 8
_MIN_CONSISTENCY = np.float32(1e-3)  # weight of a cell whose flow is not consistent, so that no window is without any


class CarriedMask(NamedTuple):
    """A mask on its way from frame to frame.

    Attributes
    ----------
    share : float32 (h, w)
        Share of each cell of the grid that the mask covers, 0..1; 0 throughout once the mask is lost.
    ratio : float32 (bin,)
        Log ratio of the colours in the mask to those around it, in its own frame.
    area : float
        Cells that it covered in its own frame.
    """

    share: np.ndarray
    ratio: np.ndarray
    area: float

    @property
    def is_lost(self) -> bool:
        """True if nothing is left to carry."""
        return not self.share.any()


class Carrier(NamedTuple):
    """Parameters of the carrying: its own, and those of colours and outlines, which are as for other masks."""

    carrying: CarryingParams
    appearance: AppearanceParams
    refinement: RefinementParams


def start_carrying(image: np.ndarray, mask: np.ndarray, grid: tuple[int, int], params: Carrier) -> CarriedMask:
    """Return the mask of a frame as it is carried from there.

    Parameters
    ----------
    image : uint8 (y, x, 3)
        RGB.
    mask : bool (y, x)
    grid : (h, w)
        Shape of the grid.
    params : Carrier
    """
    share = cv2.resize(mask.astype(np.float32), grid[::-1], interpolation=cv2.INTER_AREA)
    side = 2 * params.carrying.surroundings + 1
    near = cv2.dilate((share > 0).astype(np.uint8), np.ones((side, side), np.uint8)) > 0
    bins, inside = _bins(frame_on_grid(image, grid), params)[near], share[near].astype(np.float64)
    counted = count_sides(bins, inside, 1 - inside, params.appearance)
    return CarriedMask(share, colour_ratio(counted, params.appearance), counted.weight)


def carry_mask(
    carried: CarriedMask, image: np.ndarray, flow_back: np.ndarray, flow_forth: np.ndarray, params: Carrier
) -> CarriedMask:
    """Carry a mask to a neighbouring frame.

    It is lost where the flow is hardly consistent over the whole mask, as at a cut of the film, and where hardly
    anything is left of it, as behind another object.

    Parameters
    ----------
    carried : CarriedMask
    image : uint8 (y, x, 3)
        The neighbouring frame, RGB.
    flow_back, flow_forth : float32 (h, w, 2)
        Flow from the neighbouring frame to that of the mask, and from that of the mask to it, px of the grid per frame.
    params : Carrier

    Returns
    -------
    CarriedMask
    """
    grid = carried.share.shape
    nothing = carried._replace(share=np.zeros(grid, np.float32))
    margin = max(2 * params.refinement.radius + _MARGIN, params.carrying.surroundings)
    window = _window_after(carried.share, flow_forth, margin)
    if window is None:
        return nothing
    flow = flow_back[window]
    position = pixel_grid(grid)[window] + flow
    share = cv2.remap(carried.share, position, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    forth = cv2.remap(flow_forth, position, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    allowed = params.carrying.consistency_relative * (squared_length(flow) + squared_length(forth))
    allowed += np.float32(params.carrying.consistency_absolute)
    consistency = cv2.exp(-squared_length(flow + forth) / allowed)
    total = float(share.sum())
    if total <= 0 or float((consistency * share).sum()) < params.carrying.min_consistency * total:
        return nothing
    reduced = frame_on_grid(image, grid)[window]
    share = consistency * share + (1 - consistency) * _spread(_guide(reduced), share, consistency, params.refinement)
    evidence = np.float32(params.carrying.colour) * carried.ratio[_bins(reduced, params)]
    evidence += strays_from_mask(flow, share, _SURE, params.carrying)
    share = _decide_outline(share, evidence, params.carrying.growth)
    if float(share[share > _SURE].sum()) < params.carrying.min_area * carried.area:
        return nothing
    found = nothing.share
    found[window] = share
    return carried._replace(share=found)


def outline_mask(carried: CarriedMask, image: np.ndarray, params: RefinementParams) -> np.ndarray:
    """Return the carried mask at the size of its frame `image` uint8 (Y, X, 3), bool (Y, X); it follows the edges."""
    height, width = image.shape[:2]
    mask = np.zeros((height, width), bool)
    window = _window_around(carried.share > _SURE, carried.share.shape, 2 * params.radius + _MARGIN)
    if window is None:
        return mask
    rows, columns = window
    scale_y, scale_x = height / carried.share.shape[0], width / carried.share.shape[1]
    full = (
        slice(round(rows.start * scale_y), round(rows.stop * scale_y)),
        slice(round(columns.start * scale_x), round(columns.stop * scale_x)),
    )
    part = image[full]
    if part.size == 0:
        return mask
    near = np.ascontiguousarray(carried.share[window])
    guide = _guide(frame_on_grid(part, near.shape))
    coefficients = guided_coefficients(guide, near, params.radius, params.smoothness)
    mask[full] = apply_coefficients(_guide(part.astype(np.float32)), *coefficients) > 0.5
    return mask


def _guide(image: np.ndarray) -> np.ndarray:
    """Return grey levels float32 (y, x, 3) as colours in 0..1."""
    return image * np.float32(1 / 255)


def _bins(reduced: np.ndarray, params: Carrier) -> np.ndarray:
    return colour_bins(np.rint(reduced).astype(np.uint8), params.appearance)


def _spread(guide: np.ndarray, share: np.ndarray, weight: np.ndarray, params: RefinementParams) -> np.ndarray:
    """Return each cell's share from those of like colour around it, the less consistent ones with less weight."""
    weight = np.maximum(weight, _MIN_CONSISTENCY)
    weighed, total = (
        apply_coefficients(guide, *guided_coefficients(guide, each, params.radius, params.smoothness))
        for each in (weight * share, weight)
    )
    return np.clip(weighed / np.maximum(total, _MIN_CONSISTENCY), 0, 1)


def _decide_outline(share: np.ndarray, evidence: np.ndarray, growth: float) -> np.ndarray:
    """Add evidence to the cells that the mask covers in part; it grows by at most the share `growth`."""
    unsure = (share > _SURE) & (share < 1 - _SURE)
    part, evidence = share[unsure], evidence[unsure]
    limit = (1 + growth) * float(share.sum()) - float(share[~unsure].sum())
    decided = _with_evidence(part, evidence)
    if float(decided.sum()) > limit:
        low, high = np.float32(0), np.float32(_MAX_PENALTY)
        for _ in range(_BISECTIONS):
            middle = (low + high) / 2
            is_larger = float(_with_evidence(part, evidence - middle).sum()) > limit
            low, high = (middle, high) if is_larger else (low, middle)
        decided = _with_evidence(part, evidence - high)
    result = share.copy()
    result[unsure] = decided
    return result


def _with_evidence(share: np.ndarray, evidence: np.ndarray) -> np.ndarray:
    """Return shares whose logit is increased by `evidence`."""
    odds = np.clip(share, _SURE, 1 - _SURE)
    odds = odds / (1 - odds) * cv2.exp(evidence)
    return odds / (1 + odds)


def _window_after(share: np.ndarray, flow: np.ndarray, margin: int) -> tuple[slice, slice] | None:
    """Return rows and columns around the cells to which `flow` leads from a mask; None outside the frame."""
    rows, columns = np.nonzero(share > _SURE)
    if not len(rows):
        return None
    x, y = (columns + flow[rows, columns, 0]), (rows + flow[rows, columns, 1])
    low = np.floor([y.min(), x.min()]).astype(int) - margin
    high = np.ceil([y.max(), x.max()]).astype(int) + margin + 1
    low, high = np.clip(low, 0, share.shape), np.clip(high, 0, share.shape)
    return None if (low >= high).any() else (slice(int(low[0]), int(high[0])), slice(int(low[1]), int(high[1])))


def _window_around(mask: np.ndarray, shape: tuple[int, int], margin: int) -> tuple[slice, slice] | None:
    return _window_after(mask.astype(np.float32), np.zeros((*shape, 2), np.float32), margin)
