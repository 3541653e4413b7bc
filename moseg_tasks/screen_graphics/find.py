"""Graphics drawn into a video's frames: edges that stand still in front of a scene that moves."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np

from moseg.schemas.parameters import ScreenGraphicsParams
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.tasks.frame_grid import reduced_shape, resample
from moseg.tasks.screen_graphics.camera import camera_motions
from moseg.tasks.screen_graphics.persistent_edges import PersistentEdges, persistent_edges
from moseg.tasks.screen_graphics.regions import convex_parts, with_plain_ground
from moseg.tasks.screen_graphics.shifts import shifts

_MIN_FRAMES = 8
"""Of fewer frames too little is known: a scene may have moved too little between them."""
_PERCENTILE = 90  # of the shifts, which may be wrong in a frame in which something hides the graphic


def find_graphics(
    images: Sequence[np.ndarray], following: Sequence[np.ndarray], params: ScreenGraphicsParams
) -> ScreenGraphics:
    """Find the graphics that were drawn into a video.

    Parameters
    ----------
    images : sequence of uint8 (y, x, 3)
        RGB frames of one size, spread over the video; without black bars, whose edges stand still too.
    following : sequence of uint8 (y, x, 3)
        The frame after each of them.
    params : ScreenGraphicsParams

    Returns
    -------
    ScreenGraphics
        Without parts where the camera stands still, or where too much of the frame would be graphics. Before a camera
        at rest a large mover is taken for the background in some frames, so the fewer of them have a background that
        moves, the fewer edges may stand still.
    """
    if len(images) < _MIN_FRAMES:
        return ScreenGraphics()
    shape = images[0].shape[:2]
    grid = reduced_shape(shape, params.side)
    frames = np.stack([resample(image, grid) for image in images])
    levels = np.stack([cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY) for frame in frames])
    edges = persistent_edges(levels, params)
    if edges.share > params.max_still or not edges.is_persistent.any():
        return ScreenGraphics()
    moving = float((camera_motions(images, following) * params.side >= params.min_motion).mean())
    if edges.share > params.max_still * moving**2:
        return ScreenGraphics()
    join = max(2, round(params.join * max(grid)))
    mask = np.zeros(grid, bool)
    for region in _still_regions(edges, levels, params, join):
        mask |= with_plain_ground(region, frames, params, join)
    if mask.mean() > params.max_area:
        return ScreenGraphics()
    scale = np.array(shape[::-1]) / grid[::-1]
    polygons = (np.rint((polygon + 0.5) * scale - 0.5).astype(int) for polygon in convex_parts(mask, 4 * join))
    return ScreenGraphics(tuple(tuple(map(tuple, polygon.tolist())) for polygon in polygons))


def _still_regions(
    edges: PersistentEdges, levels: np.ndarray, params: ScreenGraphicsParams, join: int
) -> Iterator[np.ndarray]:
    """Yield the surroundings bool (y, x) of persistent edges that belong together and do not move at all."""
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * join + 1, 2 * join + 1))
    _, labels = cv2.connectedComponents(cv2.dilate(edges.is_persistent.astype(np.uint8), disc))
    rows, columns = np.nonzero(edges.is_persistent)
    label_of = labels[rows, columns]
    for label in np.unique(label_of):
        at = rows[label_of == label], columns[label_of == label]
        if len(at[0]) < params.min_edge:
            continue
        moved = shifts(levels[:, *at], edges.gradient[at])
        if moved is not None and np.percentile(moved, _PERCENTILE) <= params.max_shift:
            yield labels == label
