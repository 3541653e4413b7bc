"""Colours of the pixels of a frame: filtered textures, and more rays at the outlines of surfaces."""

import numpy as np

from moseg.tasks.synthetic.texture import MipMap, sample_texture
from moseg.tasks.synthetic.trace import Hits, trace_points
from moseg.tasks.synthetic.view import View, material_points, rays_at

SUBPIXELS = ((-0.125, -0.375), (0.375, -0.125), (0.125, 0.375), (-0.375, 0.125))
"""Places of the rays of a pixel on an outline: the rotated grid, px from the pixel's centre."""
AMBIENT = 0.78
"""Brightness of a surface seen from the side, relative to one lit in full."""
LIGHT = (0.35, -0.8, -0.5)
"""Direction to the light in each part's own coordinates, so that no surface changes brightness as it turns."""
STEEPEST = 0.15
"""Cosine of incidence below which the filter is not widened: a compromise between blur and aliasing."""


def shade_frame(view: View, hits: Hits, mipmaps: tuple[MipMap, ...]) -> np.ndarray:
    """Return the colour of each pixel.

    Parameters
    ----------
    view : View
    hits : Hits
        Of the frame's pixel centres, arrays (height, width).
    mipmaps : tuple of MipMap
        Texture of each part.

    Returns
    -------
    float32 (height, width, 3)
        RGB, 0..255.
    """
    height, width = hits.part.shape
    y, x = np.divmod(np.arange(height * width), width)
    flat = Hits(hits.depth.reshape(-1), hits.part.reshape(-1))
    colors = _shade_points(view, x.astype(np.float64), y.astype(np.float64), flat, mipmaps)
    edges = np.flatnonzero(_outlines(hits.part))
    total = np.zeros((len(edges), 3), np.float32)
    for dx, dy in SUBPIXELS:
        sub_x, sub_y = x[edges] + dx, y[edges] + dy
        total += _shade_points(view, sub_x, sub_y, trace_points(view, sub_x, sub_y), mipmaps)
    colors[edges] = total / np.float32(len(SUBPIXELS))
    return colors.reshape(height, width, 3)


def _shade_points(view: View, x: np.ndarray, y: np.ndarray, hits: Hits, mipmaps: tuple[MipMap, ...]) -> np.ndarray:
    """Return the RGB colour, float32 (N, 3), of the surfaces hit at pixels (N,)."""
    colors = np.zeros((len(x), 3), np.float32)
    for part in np.unique(hits.part[hits.part >= 0]):
        seen = np.flatnonzero(hits.part == part)
        colors[seen] = _shade_part(view, int(part), x[seen], y[seen], hits.depth[seen], mipmaps[part])
    return colors


def _shade_part(view: View, part: int, x: np.ndarray, y: np.ndarray, depth: np.ndarray, mipmap: MipMap) -> np.ndarray:
    points = material_points(view, part, x, y, depth)
    chart = view.parts[part].shape.chart(points)
    _, direction = rays_at(view, part, x, y)
    normal = chart.normal
    along = normal[:, 0] * direction[0] + normal[:, 1] * direction[1] + normal[:, 2] * direction[2]
    square = normal[:, 0] ** 2 + normal[:, 1] ** 2 + normal[:, 2] ** 2
    ray_square = direction[0] ** 2 + direction[1] ** 2 + direction[2] ** 2
    cosine = np.maximum(np.abs(along) / np.sqrt(square * ray_square), STEEPEST)
    texel = view.parts[part].texture.texel
    # The geometric mean of the footprint's two axes: one pixel covers depth / focal across, that / cosine along.
    footprint = depth / (view.camera.focal * texel * np.sqrt(cosine))
    color = sample_texture(mipmap, chart.u / texel, chart.v / texel, footprint)
    lit = (normal[:, 0] * LIGHT[0] + normal[:, 1] * LIGHT[1] + normal[:, 2] * LIGHT[2]) / np.sqrt(square)
    # A face and its reverse are lit equally, so planes need no front.
    return color * (AMBIENT + (1.0 - AMBIENT) * np.abs(lit)).astype(np.float32)[:, None]


def _outlines(part: np.ndarray) -> np.ndarray:
    """Return the pixels with a neighbour that shows another part."""
    edges = np.zeros(part.shape, bool)
    across, down = part[:, 1:] != part[:, :-1], part[1:] != part[:-1]
    edges[:, 1:] |= across
    edges[:, :-1] |= across
    edges[1:] |= down
    edges[:-1] |= down
    return edges
