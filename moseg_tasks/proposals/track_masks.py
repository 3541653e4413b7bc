"""Masks of objects of tracks: every pixel between them takes the object for which its nearest tracks vote; edges and
colours of the frame draw the outlines.
"""

from collections.abc import Iterable

import cv2
import numpy as np
from scipy.spatial import cKDTree
from scipy.special import expit

from moseg.schemas.parameters import LocalColourParams, RefinementParams, TrackMaskParams
from moseg.tasks.proposals.holes import find_holes
from moseg.tasks.proposals.point_regions import region_between
from moseg.tasks.proposals.refinement import refine_outlines

STEP = 2
"""Spacing of the grid on which pixels are labelled, px."""
BLOCK = 3
"""Side of the blocks of the grid that are labelled at once where only one object is near; odd."""
_MIDDLE = (STEP - 1) / 2
"""Place of the middle of a cell of the grid from its first pixel, px."""
_WIDER = 2.0
"""Largest margin, as a multiple of the parameter, where tracks are far apart."""
_SQUARE = np.ones((7, 7), np.uint8)
"""Around a track: a part that reaches into it is the track's."""
_NO_TRACK = -1
_TINY = 1e-12
"""Weight of a vote by distance alone, for pixels that resemble none of their tracks."""


def track_masks(
    frames: Iterable[np.ndarray],
    flows: Iterable[np.ndarray],
    points: np.ndarray,
    visible: np.ndarray,
    objects: np.ndarray,
    start: int,
    params: TrackMaskParams,
    refinement: RefinementParams,
    colours: LocalColourParams | None = None,
) -> np.ndarray:
    """Return the object of every pixel.

    Parameters
    ----------
    frames : iterable of uint8 (y, x, rgb)
        Consecutive frames; the first one is frame `start` of the tracks.
    flows : iterable of float32 (y, x, uv)
        Motion from each of these frames to the next, px/frame; finite.
    points : float32 (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    objects : uint16 (track,)
        0 = background.
    start : int
    params : TrackMaskParams
    refinement : RefinementParams
        Of the outlines, along the edges of the frame.
    colours : LocalColourParams, optional
        Of both sides of the outlines; without them the votes alone are aligned with the edges.

    Returns
    -------
    uint16 (frame, y, x)
        0 = background.
    """
    masks = []
    for frame, (image, flow) in enumerate(zip(frames, flows, strict=True), start):
        place, motion, seen = _seen_tracks(points, visible, objects, frame)
        grid = _label_grid(image, flow, place, motion, seen, params)
        masks.append(_tidy(_draw(image, grid, params, refinement, colours), place, seen))
    return np.stack(masks)


def number_seen(masks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number the objects that have a pixel 1, 2, ... in the order of their labels.

    Parameters
    ----------
    masks : uint16 (frame, y, x)
        0 = background.

    Returns
    -------
    masks : uint16 (frame, y, x)
    labels : int64 (object,)
        The former label of each object.
    """
    is_seen = np.zeros(np.iinfo(np.uint16).max + 1, bool)
    for mask in masks:
        is_seen[mask] = True
    is_seen[0] = False
    return np.where(is_seen, np.cumsum(is_seen), 0).astype(np.uint16)[masks], np.flatnonzero(is_seen)


def _seen_tracks(points: np.ndarray, visible: np.ndarray, objects: np.ndarray, frame: int) -> tuple:
    """Return place, motion (NaN where unknown) and object of the tracks that a frame shows."""
    seen = np.flatnonzero(visible[:, frame])
    is_last = frame + 1 == visible.shape[1]
    other = frame - 1 if is_last else frame + 1
    place = points[seen, frame]
    motion = points[seen, other] - place
    motion[~visible[seen, other]] = np.nan
    return place, -motion if is_last else motion, objects[seen]


def _draw(
    image: np.ndarray,
    grid: np.ndarray,
    params: TrackMaskParams,
    refinement: RefinementParams,
    colours: LocalColourParams | None,
) -> np.ndarray:
    """Return the labels of a grid at the size of its frame, uint16 (y, x)."""
    if not params.softness or not grid.any():
        return cv2.resize(grid, image.shape[1::-1], interpolation=cv2.INTER_NEAREST)
    return refine_outlines(image, grid, _soften(grid > 0, params.softness), refinement, colours)


def _tidy(labels: np.ndarray, place: np.ndarray, objects: np.ndarray) -> np.ndarray:
    """Return labels uint16 (y, x) without parts that have no track of their object, and holes that have no other track.

    A track that lies a little outside of a part counts as the part's. Where an object's tracks all lie outside of it,
    its largest part is kept.
    """
    x, y = np.clip(np.rint(place).astype(int), 0, np.array(labels.shape[::-1]) - 1).T
    tidied = np.zeros_like(labels)
    for label in np.unique(labels[labels > 0]):
        count, parts, stats, _ = cv2.connectedComponentsWithStats((labels == label).astype(np.uint8))
        near = np.zeros(labels.shape, np.uint8)
        near[y[objects == label], x[objects == label]] = 1
        has_track = np.zeros(count, bool)
        has_track[parts[cv2.dilate(near, _SQUARE) > 0]] = True
        has_track[0] = False
        if not has_track.any():
            has_track[1 + stats[1:, cv2.CC_STAT_AREA].argmax()] = True
        tidied[has_track[parts]] = label
    owner = np.full(labels.shape, _NO_TRACK, np.int32)
    owner[y, x] = objects
    for hole in list(find_holes(tidied)):
        if np.isin(owner[hole.box][hole.inside], (_NO_TRACK, hole.label)).all():
            tidied[hole.box][hole.inside] = hole.label
    return tidied


def _soften(mask: np.ndarray, softness: float) -> np.ndarray:
    """Return how sure it is that cells of the grid belong to a mask, float32 (y, x): a half at its outline."""
    inside, outside = (
        cv2.distanceTransform(side.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) for side in (mask, ~mask)
    )
    return expit((np.where(mask, inside - 0.5, 0.5 - outside) * (STEP / softness)).astype(np.float32))


def _label_grid(
    image: np.ndarray,
    flow: np.ndarray,
    place: np.ndarray,
    motion: np.ndarray,
    objects: np.ndarray,
    params: TrackMaskParams,
) -> np.ndarray:
    """Return the object of every pixel of the grid, uint16 (y, x)."""
    shape = tuple(-(-side // STEP) for side in image.shape[:2])
    if not objects.any():
        return np.zeros(shape, np.uint16)
    tree = cKDTree(place)
    num_neighbours = min(params.num_neighbours, len(place))
    candidates = _near_objects(place[objects > 0], shape, params.radius)
    grid, is_decided = _label_blocks(candidates, tree, objects, num_neighbours)
    rows, columns = np.nonzero(candidates & ~is_decided)
    pixels = np.stack([columns, rows], axis=1) * float(STEP) + _MIDDLE
    distance, near = (found.reshape(-1, num_neighbours) for found in tree.query(pixels, k=num_neighbours))
    grey = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), (0, 0), params.grey_blur)
    weights = _weigh(grey, flow, rows * STEP, columns * STEP, distance, near, place, motion, params)
    grid[rows, columns] = _elect(objects[near], weights)
    if params.closing:
        for label in np.unique(grid[grid > 0]):
            own = place[objects == label]
            reach = np.array([params.closing, _margin(own, params), params.edge]) / STEP
            grid[(grid == label) & ~region_between((own - _MIDDLE) / STEP, shape, *reach)] = 0
    return cv2.medianBlur(grid, 2 * params.smoothing + 1) if params.smoothing else grid


def _margin(place: np.ndarray, params: TrackMaskParams) -> float:
    """Return how far around its tracks an object may reach, px: tracks far apart tell less of the outline."""
    if len(place) < 2:
        return params.margin * _WIDER
    spacing = np.median(cKDTree(place).query(place, k=2)[0][:, 1])
    return float(np.clip(spacing, params.margin, params.margin * _WIDER))


def _near_objects(place: np.ndarray, shape: tuple[int, int], radius: float) -> np.ndarray:
    """Return which pixels of the grid are within `radius` px of one of the tracks, bool (y, x)."""
    far = np.full(shape, 255, np.uint8)
    cells = np.clip(np.rint((place - _MIDDLE) / STEP).astype(int), 0, [shape[1] - 1, shape[0] - 1])
    far[cells[:, 1], cells[:, 0]] = 0
    return cv2.distanceTransform(far, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * STEP <= radius


def _label_blocks(
    candidates: np.ndarray, tree: cKDTree, objects: np.ndarray, num_neighbours: int
) -> tuple[np.ndarray, np.ndarray]:
    """Label the blocks of the grid in which the nearest tracks of every pixel belong to one object.

    Returns
    -------
    grid : uint16 (y, x)
        Object of each candidate that is decided, else 0.
    is_decided : bool (y, x)
    """
    height, width = candidates.shape
    sides = -(-height // BLOCK), -(-width // BLOCK)
    padded = np.zeros((sides[0] * BLOCK, sides[1] * BLOCK), bool)
    padded[:height, :width] = candidates
    rows, columns = np.nonzero(padded.reshape(sides[0], BLOCK, sides[1], BLOCK).any(axis=(1, 3)))
    half = BLOCK // 2
    centres = (np.stack([columns, rows], axis=1) * BLOCK + half) * float(STEP) + _MIDDLE
    farthest = tree.query(centres, k=[num_neighbours])[0][:, 0]
    # The nearest tracks of any pixel of the block lie within this distance of its centre.
    reach = farthest + 2 * np.sqrt(2) * half * STEP
    labels = np.unique(objects)
    distance = np.array([cKDTree(tree.data[objects == label]).query(centres)[0] for label in labels])
    nearest = distance.argmin(axis=0)
    is_alone = (distance <= reach).sum(axis=0) == 1
    blocks = np.zeros((2, *sides), np.uint16)
    blocks[0, rows, columns] = np.where(is_alone, labels[nearest], 0)
    blocks[1, rows, columns] = is_alone
    spread = blocks.repeat(BLOCK, axis=1).repeat(BLOCK, axis=2)[:, :height, :width]
    return np.where(candidates, spread[0], 0).astype(np.uint16), spread[1] > 0


def _weigh(
    grey: np.ndarray,
    flow: np.ndarray,
    rows: np.ndarray,
    columns: np.ndarray,
    distance: np.ndarray,
    near: np.ndarray,
    place: np.ndarray,
    motion: np.ndarray,
    params: TrackMaskParams,
) -> np.ndarray:
    """Return the weight of each near track's vote for pixels (rows, columns), float32 (pixel, neighbour)."""
    distance = distance.astype(np.float32)
    x, y = np.ascontiguousarray(place.T)
    own_grey = cv2.remap(grey.astype(np.float32), x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    own_flow = cv2.remap(flow, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).reshape(-1, 2)
    own_flow = np.where(np.isfinite(motion), motion, own_flow)
    flow, grey = (_mean_of_cells(values)[rows, columns] for values in (flow, grey))
    scale = np.float32(params.motion) + np.float32(params.relative_motion) * np.hypot(flow[:, 0], flow[:, 1])
    du, dv = (own_flow[:, axis][near] - flow[:, None, axis] for axis in (0, 1))
    dissimilar = (du * du + dv * dv) / (scale * scale)[:, None]
    dissimilar += ((own_grey.ravel()[near] - grey[:, None]) / np.float32(params.grey)) ** 2
    by_distance = np.exp(np.float32(-0.5 / params.distance**2) * distance * distance)
    return by_distance * (np.exp(np.float32(-0.5) * dissimilar) + np.float32(_TINY))


def _mean_of_cells(values: np.ndarray) -> np.ndarray:
    """Return the mean of the cell of the grid that begins at each pixel, float32 (y, x) or (y, x, channel)."""
    return cv2.blur(values.astype(np.float32), (STEP, STEP), anchor=(0, 0), borderType=cv2.BORDER_REPLICATE)


def _elect(labels: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the label with the largest summed weight in each row, uint16 (pixel,); the lowest one of equal sums."""
    best, chosen = np.zeros(len(labels), np.float32), np.zeros(len(labels), np.uint16)
    for label in np.unique(labels):
        total = np.where(labels == label, weights, 0).sum(axis=1)
        better = total > best
        best[better], chosen[better] = total[better], label
    return chosen
