"""Ray casting: the first part on each pixel's ray, and its depth."""

from itertools import product
from typing import NamedTuple

import numpy as np

from moseg.tasks.synthetic.shapes import NEAREST_DEPTH, Billboard
from moseg.tasks.synthetic.view import View, rays_at


class Hits(NamedTuple):
    """First parts on rays.

    Attributes
    ----------
    depth : float64, one per ray
        Distance along the optical axis, metres; infinite if there is no part.
    part : int64, one per ray
        Index of the part; -1 if there is none.
    """

    depth: np.ndarray
    part: np.ndarray


def trace_frame(view: View, height: int, width: int) -> Hits:
    """Return the first hits of the rays through every pixel centre; arrays (height, width)."""
    hits = _nothing((height, width))
    x, y = np.arange(width, dtype=np.float64)[None, :], np.arange(height, dtype=np.float64)[:, None]
    for part in range(len(view.parts)):
        rows, columns = _window(view, part, height, width)
        if rows.start < rows.stop and columns.start < columns.stop:
            window = Hits(hits.depth[rows, columns], hits.part[rows, columns])
            _meet(view, part, x[:, columns], y[rows], window)
    return hits


def trace_points(view: View, x: np.ndarray, y: np.ndarray) -> Hits:
    """Return the first hits of the rays through image points ``x``, ``y``, float64 (N,), px."""
    hits = _nothing(x.shape)
    for part in range(len(view.parts)):
        _meet(view, part, x, y, hits)
    return hits


def _nothing(shape: tuple[int, ...]) -> Hits:
    return Hits(np.full(shape, np.inf), np.full(shape, -1, np.int64))


def _meet(view: View, part: int, x: np.ndarray, y: np.ndarray, hits: Hits) -> None:
    """Write a part into ``hits`` wherever it is nearer than the present one."""
    origin, direction = rays_at(view, part, x, y)
    shape = view.parts[part].shape
    found = (
        shape.hit(origin, direction, view.bends[part]) if isinstance(shape, Billboard) else shape.hit(origin, direction)
    )
    closer = found < hits.depth
    np.copyto(hits.depth, found, where=closer)
    np.copyto(hits.part, part, where=closer)


def _window(view: View, part: int, height: int, width: int) -> tuple[slice, slice]:
    """Return the rows and columns of the frame that contain a part: the box about its projected bounding box."""
    extent = view.parts[part].shape.extent
    if extent is None:
        return slice(0, height), slice(0, width)
    reach = (extent[0] + sum(abs(c) for c in view.bends[part]), *extent[1:])
    rotation, translation = view.poses[part]
    corners = np.array(list(product(*([-half, half] for half in reach))))
    x, y, z = ((corners * rotation[row]).sum(axis=1) + translation[row] for row in range(3))
    if z.max() <= NEAREST_DEPTH:
        return slice(0, 0), slice(0, 0)
    if z.min() <= NEAREST_DEPTH:
        return slice(0, height), slice(0, width)
    focal, center = view.camera.focal, view.camera.center
    x, y = focal * x / z + center[0], focal * y / z + center[1]
    return _span(y, height), _span(x, width)


def _span(values: np.ndarray, size: int) -> slice:
    first, last = int(np.floor(values.min())), int(np.ceil(values.max())) + 1
    return slice(min(max(first, 0), size), max(min(last, size), 0))
