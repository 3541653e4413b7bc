"""An object grown from points in a frame: a region that moves apart from the background, or one of like colour."""

from typing import NamedTuple

import cv2
import numpy as np
from scipy import ndimage

from moseg.schemas.parameters import AppearanceParams, GrowingParams, RefinementParams
from moseg.tasks.appearance import colour_bins, colour_ratio, count_sides
from moseg.tasks.frame_grid import frame_on_grid
from moseg.tasks.proposals.guided_filter import apply_coefficients, guided_coefficients
from moseg.tasks.saliency.grid import squared_length, vector_length

_NUM_LEVELS = 16
_SURE = 0.02


class Grower(NamedTuple):
    """Parameters of the growth: its own, and those of colours and outlines, which are as for other masks."""

    growing: GrowingParams
    appearance: AppearanceParams
    refinement: RefinementParams


def grow_object(
    image: np.ndarray,
    saliency: np.ndarray,
    residual_flows: np.ndarray,
    points: np.ndarray,
    not_points: np.ndarray,
    params: Grower,
) -> np.ndarray:
    """Grow an object from points.

    The evidence of a cell is its motion saliency where it moves like the cells at the point, or, if nothing stands out
    there, the likeness of its colour. At the level of evidence with the largest step across its outline, the connected
    region around the point is the object. Colours inside and around it then correct the outline.

    Parameters
    ----------
    image : uint8 (Y, X, 3)
        RGB.
    saliency : float32 (h, w)
        Motion saliency on the working grid, 0..1.
    residual_flows : float32 (2, h, w, 2)
        Flow to the previous and to the next frame less the background's, px of the grid per frame.
    points, not_points : float64 (N, 2)
        xy, px of `image`: points on the object, and points that it does not cover.
    params : Grower

    Returns
    -------
    bool (Y, X)
        It covers the points in any case, and what is connected to them.
    """
    grid = saliency.shape
    reduced = frame_on_grid(image, grid)
    inside, outside = (_cells(each, image.shape[:2], grid) for each in (points, not_points))
    region = np.zeros(grid, bool)
    velocity = cv2.GaussianBlur((residual_flows[1] - residual_flows[0]) / 2, (0, 0), 1)
    colours = cv2.GaussianBlur(cv2.cvtColor(reduced * np.float32(1 / 255), cv2.COLOR_RGB2LAB), (0, 0), 1)
    for cell in inside:
        spot = _disc(cell, params.growing.spot, grid)
        moving = saliency * _like_motion(velocity, spot, params.growing)
        found, step = _region_at(moving, spot, outside, params.growing.max_area, params.growing)
        if step < params.growing.min_step:
            alike = _like_colour(colours, spot, params.growing)
            found, _ = _region_at(alike, spot, outside, params.growing.max_still_area, params.growing)
        region |= found
    region = _follow_colours(region, reduced, params)
    region &= ~_nearer(outside, inside, grid)
    mask = _enlarge(_around(region, inside), image, params.refinement)
    # The filter drops what is smaller than its window.
    x, y = np.clip(np.rint(points).astype(int), 0, [image.shape[1] - 1, image.shape[0] - 1]).T
    mask[y, x] = True
    return mask


def _cells(points: np.ndarray, size: tuple[int, int], grid: tuple[int, int]) -> list[tuple[int, int]]:
    """Return the cells (x, y) of points xy on a frame of `size`."""
    scale = np.array([grid[1] / size[1], grid[0] / size[0]])
    cells = np.rint((points + 0.5) * scale - 0.5).astype(int)
    return [tuple(cell) for cell in np.clip(cells, 0, [grid[1] - 1, grid[0] - 1]).tolist()]


def _disc(cell: tuple[int, int], radius: float, grid: tuple[int, int]) -> np.ndarray:
    y, x = np.ogrid[: grid[0], : grid[1]]
    return (x - cell[0]) ** 2 + (y - cell[1]) ** 2 <= radius**2


def _like_motion(velocity: np.ndarray, spot: np.ndarray, params: GrowingParams) -> np.ndarray:
    """Return how alike each cell's residual motion is to that of a spot, 0..1."""
    own = np.median(velocity[spot], axis=0)
    scale = np.float32(params.motion_relative) * vector_length(own) + np.float32(params.motion_absolute)
    return cv2.exp(-squared_length(velocity - own) / (2 * scale * scale))


def _like_colour(colours: np.ndarray, spot: np.ndarray, params: GrowingParams) -> np.ndarray:
    """Return how alike each cell's colour is to those of a spot, 0..1; lightness counts half."""
    own, spread = colours[spot].mean(axis=0), colours[spot].std(axis=0)
    apart = (colours - own) / (spread + np.float32(params.colour) * np.float32([1, 0.5, 0.5]))
    return cv2.exp(-0.5 * (apart * apart).sum(axis=-1))


def _region_at(
    evidence: np.ndarray,
    spot: np.ndarray,
    outside: list[tuple[int, int]],
    max_area: float,
    params: GrowingParams,
) -> tuple[np.ndarray, float]:
    """Return the region of evidence around a spot, and the step of the mean evidence across its outline.

    The spot itself, and no step, where there is no region of a plausible size without the cells `outside`.
    """
    y, x = (int(each) for each in np.unravel_index(np.where(spot, evidence, -1).argmax(), spot.shape))
    best, largest = spot, 0.0
    for level in np.geomspace(params.min_level, 0.9, _NUM_LEVELS):
        if level >= evidence[y, x]:
            break
        parts, _ = ndimage.label(evidence > level)
        region = ndimage.binary_fill_holes(parts == parts[y, x])
        share = region.mean()
        if not params.min_area <= share <= max_area or any(region[v, u] for u, v in outside):
            continue
        near = np.ones((2 * params.band + 1,) * 2, np.uint8)
        inner = region & (cv2.erode(region.astype(np.uint8), near) == 0)
        outer = ~region & (cv2.dilate(region.astype(np.uint8), near) > 0)
        if inner.any() and outer.any():
            step = float(evidence[inner].mean(dtype=np.float64) - evidence[outer].mean(dtype=np.float64))
            if step > largest:
                best, largest = region, step
    return best, largest


def _follow_colours(region: np.ndarray, reduced: np.ndarray, params: Grower) -> np.ndarray:
    """Return the region whose outline follows the colours inside and around it."""
    bins = colour_bins(np.rint(reduced).astype(np.uint8), params.appearance)
    guide = reduced * np.float32(1 / 255)
    side = 2 * params.growing.surroundings + 1
    refinement = params.refinement
    for _ in range(params.growing.rounds):
        near = cv2.dilate(region.astype(np.uint8), np.ones((side, side), np.uint8)) > 0
        inside = region[near].astype(np.float64)
        ratio = colour_ratio(count_sides(bins[near], inside, 1 - inside, params.appearance), params.appearance)
        soft = cv2.GaussianBlur(region.astype(np.float32), (0, 0), params.growing.band)
        odds = np.clip(soft, _SURE, 1 - _SURE)
        odds = odds / (1 - odds) * cv2.exp(np.float32(params.growing.colour_weight) * ratio[bins])
        soft = np.where((soft > _SURE) & (soft < 1 - _SURE), odds / (1 + odds), soft)
        slopes = guided_coefficients(guide, soft, refinement.radius, refinement.smoothness)
        found = apply_coefficients(guide, *slopes) > 0.5
        # Of a region as small as the filter's window nothing would be left.
        if 2 * found.sum() < region.sum():
            break
        region = found
    return region


def _nearer(outside: list[tuple[int, int]], inside: list[tuple[int, int]], grid: tuple[int, int]) -> np.ndarray:
    """Return the cells around `outside` that are closer to them than half the way to the nearest of `inside`."""
    y, x = np.ogrid[: grid[0], : grid[1]]
    cut = np.zeros(grid, bool)
    for u, v in outside:
        reach = min(np.hypot(u - p, v - q) for p, q in inside) / 2
        cut |= np.hypot(x - u, y - v) <= reach
    return cut


def _around(region: np.ndarray, inside: list[tuple[int, int]]) -> np.ndarray:
    """Return the connected parts of a region that hold one of the cells, which belong to it."""
    region = region.copy()
    for x, y in inside:
        region[y, x] = True
    parts, _ = ndimage.label(region, np.ones((3, 3)))
    return np.isin(parts, [parts[y, x] for x, y in inside])


def _enlarge(region: np.ndarray, image: np.ndarray, params: RefinementParams) -> np.ndarray:
    """Return the region at the size of its frame, along the frame's edges."""
    guide = frame_on_grid(image, region.shape) * np.float32(1 / 255)
    coefficients = guided_coefficients(guide, region.astype(np.float32), params.radius, params.smoothness)
    soft = apply_coefficients(image.astype(np.float32) * np.float32(1 / 255), *coefficients)
    near = cv2.resize(
        cv2.dilate(region.astype(np.uint8), np.ones((3, 3), np.uint8)),
        image.shape[1::-1],
        interpolation=cv2.INTER_NEAREST,
    )
    mask = (soft > 0.5) & (near > 0)
    # What is smaller than the filter's window would vanish.
    return mask if mask.any() else cv2.resize(region.astype(np.uint8), image.shape[1::-1]) > 0
