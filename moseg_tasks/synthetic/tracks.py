"""Exact tracks of surface points, with visibility by ray casting."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.synthetic.scene import Scene
from moseg.tasks.synthetic.shapes import NEAREST_DEPTH
from moseg.tasks.synthetic.trace import Hits, trace_points
from moseg.tasks.synthetic.view import View, material_points, object_of_parts, project_points

_SAME_DEPTH = 1e-6
"""Relative difference of depth within which a ray hits the point itself: far above float64 rounding."""


class Tracks(NamedTuple):
    """Points on surfaces over time.

    Attributes
    ----------
    points : float32 (N, T, 2)
        xy, px; also where a point is hidden or outside the frame, and (-1, -1) where it is behind the camera.
    visible : bool (N, T)
        Inside the frame and not hidden.
    """

    points: np.ndarray
    visible: np.ndarray


def track_points(scene: Scene, views: list[View], hits: list[Hits]) -> Tracks:
    """Track points of every object and of the backdrop through all frames.

    Every `seed_every` frames each object gets new points, drawn from the pixels inside its outline, up to the wanted
    number of visible ones.
    """
    owners = object_of_parts(scene)
    rng = np.random.default_rng([scene.seed, 1])
    tracks = [(np.zeros((0, len(views), 2)), np.zeros((0, len(views)), bool))]
    known = np.zeros(0, np.int64)
    for frame in range(0, len(views), scene.seed_every):
        visible = np.concatenate([mask for _, mask in tracks])[:, frame]
        seen = np.bincount(known[visible], minlength=len(scene.things) + 1)
        wanted = np.full(len(scene.things) + 1, scene.points_per_object)
        wanted[0] = scene.points_on_backdrop
        for identity, missing in enumerate(wanted - seen):
            pixels = np.flatnonzero(_interior(owners[hits[frame].part] == identity))
            if missing <= 0 or len(pixels) == 0:
                continue
            chosen = np.sort(rng.choice(pixels, min(missing, len(pixels)), replace=False))
            tracks.append(_follow(scene, views, frame, hits[frame], chosen))
            known = np.concatenate([known, np.full(len(chosen), identity)])
    points, visible = (np.concatenate(column) for column in zip(*tracks, strict=True))
    return Tracks(points.astype(np.float32), visible)


def _follow(
    scene: Scene, views: list[View], frame: int, hits: Hits, pixels: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions float64 (N, T, 2) and visibility (N, T) of the points seen at flat ``pixels`` of a frame."""
    y, x = np.divmod(pixels, scene.width)
    part, depth = hits.part.reshape(-1)[pixels], hits.depth.reshape(-1)[pixels]
    rows = {int(index): np.flatnonzero(part == index) for index in np.unique(part)}
    material = {
        index: material_points(views[frame], index, x[own].astype(float), y[own].astype(float), depth[own])
        for index, own in rows.items()
    }
    points, visible = np.empty((len(pixels), len(views), 2)), np.empty((len(pixels), len(views)), bool)
    for t, view in enumerate(views):
        places = np.empty((3, len(pixels)))
        for index, own in rows.items():
            places[:, own] = project_points(view, index, material[index])
        points[:, t], visible[:, t] = _see(scene, view, part, places)
    return points, visible


def _see(scene: Scene, view: View, part: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (N, 2) and visibility (N,) of points of parts (N,) at pixels x, y and depths, (3, N)."""
    x, y, z = places
    inside = (x >= 0) & (x <= scene.width - 1) & (y >= 0) & (y <= scene.height - 1)
    met = trace_points(view, x, y)
    behind = z <= NEAREST_DEPTH
    visible = inside & ~behind & (met.part == part) & (np.abs(met.depth - z) <= _SAME_DEPTH * z)
    return np.where(behind[:, None], -1.0, np.stack([x, y], axis=1)), visible


def _interior(mask: np.ndarray) -> np.ndarray:
    """Return the pixels of a mask whose four neighbours belong to it; the frame's border is outside."""
    inner = np.zeros_like(mask)
    middle = mask[1:-1, 1:-1]
    inner[1:-1, 1:-1] = middle & mask[:-2, 1:-1] & mask[2:, 1:-1] & mask[1:-1, :-2] & mask[1:-1, 2:]
    return inner
