"""Rendering of a scene: frames and their exact masks, flow, inverse depth and point tracks.

Geometry is float64 arithmetic on one thread without BLAS, so a scene has the same bytes in every process. Per-pixel
maps use only correctly rounded operations (+ - * / sqrt), alike on all processors. What may vary: sines and cosines
of a few scalars come from the C library, whose last bit differs between libraries and could move a pixel on an outline;
and numpy may change its generators' streams between versions, and with them textures, noise and tracked points.
"""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.tasks.synthetic.scene import Scene
from moseg.tasks.synthetic.shade import shade_frame
from moseg.tasks.synthetic.texture import paint_texture
from moseg.tasks.synthetic.trace import Hits, trace_frame
from moseg.tasks.synthetic.tracks import track_points
from moseg.tasks.synthetic.view import View, material_points, object_of_parts, project_points, view_at


class RenderedScene(NamedTuple):
    """A rendered sequence of T frames.

    Attributes
    ----------
    images : uint8 (T, H, W, 3)
        RGB.
    objects : uint16 (T, H, W)
        Identity of the object, static or moving; 0 for the backdrop.
    moving : uint16 (T, H, W)
        The same identities with static objects 0: the ground truth.
    flow_forward : float32 (T - 1, H, W, 2)
        (u, v) from frame m to m + 1 of the surface seen at m, px/frame; also if it is hidden at m + 1.
    flow_backward : float32 (T - 1, H, W, 2)
        (u, v) from frame m + 1 to m of the surface seen at m + 1, px/frame.
    inverse_depth : float32 (T, H, W)
        1 / z along the optical axis, 1/m.
    points : float32 (N, T, 2)
        xy of surface points, px.
    visible : bool (N, T)
        Inside the frame and not hidden.
    """

    images: np.ndarray
    objects: np.ndarray
    moving: np.ndarray
    flow_forward: np.ndarray
    flow_backward: np.ndarray
    inverse_depth: np.ndarray
    points: np.ndarray
    visible: np.ndarray


def render_scene(scene: Scene) -> RenderedScene:
    """Render a scene.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    RenderedScene

    Raises
    ------
    InputError
        The backdrop leaves a part of a frame empty.
    """
    views = [view_at(scene, t) for t in range(scene.num_frames)]
    hits = [trace_frame(view, scene.height, scene.width) for view in views]
    for frame, hit in enumerate(hits):
        if (hit.part < 0).any():
            raise InputError(
                "the backdrop does not fill the frame",
                where=f"frame {frame}",
                got=f"{(hit.part < 0).sum()} empty pixels",
            )
    owners = object_of_parts(scene)
    moves = np.array([False] + [thing.is_moving for thing in scene.things])
    objects = np.stack([owners[hit.part] for hit in hits])
    tracks = track_points(scene, views, hits)
    pairs = range(scene.num_frames - 1)
    return RenderedScene(
        images=_render_images(scene, views, hits),
        objects=objects,
        moving=np.where(moves[objects], objects, 0).astype(np.uint16),
        flow_forward=np.stack([_flow(views[m], views[m + 1], hits[m]) for m in pairs]),
        flow_backward=np.stack([_flow(views[m + 1], views[m], hits[m + 1]) for m in pairs]),
        inverse_depth=np.stack([1.0 / hit.depth for hit in hits]).astype(np.float32),
        points=tracks.points,
        visible=tracks.visible,
    )


def _render_images(scene: Scene, views: list[View], hits: list[Hits]) -> np.ndarray:
    """Render shaded frames with the sensor's gain, bias, noise and rounding."""
    painted = {texture: paint_texture(texture) for texture in {part.texture for part in views[0].parts}}
    mipmaps = tuple(painted[part.texture] for part in views[0].parts)
    rng = np.random.default_rng([scene.seed, 0])
    images = np.empty((scene.num_frames, scene.height, scene.width, 3), np.uint8)
    for t, (view, hit) in enumerate(zip(views, hits, strict=True)):
        colors = shade_frame(view, hit, mipmaps) * np.float32(scene.gain.at(t)) + np.float32(scene.bias.at(t))
        # The sum of two uniform deviates: nearly normal, without the logarithms of a normal deviate.
        noise = rng.random(colors.shape, np.float32) + rng.random(colors.shape, np.float32) - np.float32(1.0)
        colors += noise * np.float32(scene.noise * 6.0**0.5)
        images[t] = np.clip(np.rint(colors), 0, 255)
    return images


def _flow(view0: View, view1: View, hits: Hits) -> np.ndarray:
    """Return the displacement, float32 (H, W, 2), of each surface point seen in ``view0`` to its place in ``view1``."""
    height, width = hits.part.shape
    part, depth = hits.part.reshape(-1), hits.depth.reshape(-1)
    flow = np.empty((height * width, 2), np.float32)
    for index in np.unique(part):
        seen = np.flatnonzero(part == index)
        y, x = np.divmod(seen, width)
        x, y = x.astype(np.float64), y.astype(np.float64)
        x1, y1, _ = project_points(view1, index, material_points(view0, index, x, y, depth[seen]))
        flow[seen, 0], flow[seen, 1] = x1 - x, y1 - y
    return flow.reshape(height, width, 2)
