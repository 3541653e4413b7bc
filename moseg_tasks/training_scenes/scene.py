"""One training scene: what is in it, rendered to three frames with the moving pixels of the middle one."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.tasks.training_scenes.camera import CameraStep, camera_flow, draw_camera
from moseg.tasks.training_scenes.layers import (
    MARGIN,
    Layer,
    add_layer,
    canvas_points,
    empty_canvas,
    sample_canvas,
)
from moseg.tasks.training_scenes.movers import OwnMotion, displacement_of, draw_own_motion, own_displacement
from moseg.tasks.training_scenes.sensor import expose
from moseg.tasks.training_scenes.shapes import Part, Place, draw_decoy, draw_mover
from moseg.tasks.training_scenes.surfaces import draw_surfaces, smooth_noise

_CERTAIN = 0.35  # px/frame of own motion that are surely motion
_NOTHING = 0.1  # px/frame of own motion that are surely none


class TrainingScene(NamedTuple):
    """Three frames and the truth of the middle one.

    Attributes
    ----------
    frames : uint8 (3, y, x, 3)
        Before, middle, after.
    label : float32 (y, x)
        Share of each pixel that moves on its own.
    weight : float32 (y, x)
        1 where the label counts, 0 where motion is too small to tell.
    """

    frames: np.ndarray
    label: np.ndarray
    weight: np.ndarray


class _Setting(NamedTuple):
    rng: np.random.Generator
    shape: tuple[int, int]
    canvas: tuple[int, int]
    camera: tuple[CameraStep, CameraStep]
    inverse_depth: np.ndarray
    textures: np.ndarray


def draw_scene(rng: np.random.Generator, shape: tuple[int, int], textures: np.ndarray) -> TrainingScene:
    """Draw and render a scene.

    Parameters
    ----------
    rng : numpy.random.Generator
    shape : tuple of int
        Height and width of the frames, px; parameters are meant for a longer side of about 427.
    textures : uint8 (count, side, side, 3)
        Of `paint_textures`.

    Returns
    -------
    TrainingScene
    """
    points = canvas_points(shape)
    inverse_depth = draw_surfaces(rng, points, float(max(shape)))
    setting = _Setting(rng, shape, points.shape[:2], draw_camera(rng), inverse_depth, textures)
    things = []
    for is_mover, count in (
        (True, rng.choice(5, p=[0.1, 0.48, 0.23, 0.12, 0.07])),
        (False, min(int(rng.poisson(1.5)), 5)),
    ):
        things += [_draw_thing(setting, is_mover) for _ in range(count)]
    things.sort(key=lambda thing: thing[0])
    canvas = empty_canvas(shape)
    for layer in _backdrop(setting):
        add_layer(canvas, layer)
    for _, layers in things:
        for layer in layers:
            add_layer(canvas, layer)
    return TrainingScene(expose(rng, canvas.frames), canvas.label, canvas.weight)


def _backdrop(setting: _Setting) -> list[Layer]:
    """Draw the surfaces behind everything: one texture, with regions of up to two others on it."""
    rng, shape, side = setting.rng, setting.shape, float(max(setting.shape))
    ripple = _ripples(setting) if rng.random() < 0.25 else None

    def displacement(step: int, points: np.ndarray) -> np.ndarray:
        depth = sample_canvas(setting.inverse_depth, points, shape)
        flow = camera_flow(setting.camera[(step + 1) // 2], depth, points, side)
        return flow if ripple is None else flow + sample_canvas(ripple[(step + 1) // 2], points, shape)

    layers = [Layer(None, displacement, _texture(setting), _chart(rng))]
    for _ in range(rng.integers(3)):
        layers.append(Layer(_region(setting), displacement, _texture(setting), _chart(rng)))
    return layers


def _region(setting: _Setting) -> np.ndarray:
    """Draw where the backdrop has another texture: above an uneven horizon, or in patches; uint8 (y, x)."""
    rng, height = setting.rng, setting.canvas[0]
    field = smooth_noise(rng, setting.canvas, rng.uniform(20, 200)) - rng.uniform(-0.5, 1.0)
    if rng.random() < 0.5:
        above = rng.uniform(0.1, 0.7) * height - np.arange(height, dtype=np.float32)[:, None]
        field = 0.05 * above + rng.uniform(0, 1) * field
    return np.clip(128 + 255 * rng.choice([0.3, 2.0]) * field, 0, 255).astype(np.uint8)


def _ripples(setting: _Setting) -> np.ndarray:
    """Draw the motion of water or leaves in a part of the backdrop, which counts as static: (2, y, x, 2), px."""
    rng, canvas = setting.rng, setting.canvas
    where = 1 / (1 + np.exp(-8 * (smooth_noise(rng, canvas, rng.uniform(60, 300)) - rng.uniform(-0.5, 1))))
    scale, size = rng.uniform(6, 30), 0.2 * 10 ** rng.random()
    fields = [np.stack([smooth_noise(rng, canvas, scale) for _ in range(2)], axis=-1) for _ in range(2)]
    return (size * where[None, ..., None] * np.stack(fields)).astype(np.float32)


def _draw_thing(setting: _Setting, is_mover: bool) -> tuple[float, list[Layer]]:
    """Draw a thing: its inverse depth and its layers."""
    rng, (height, width) = setting.rng, setting.shape
    radius = min(height, width) * (0.05 * 12 ** rng.random() if is_mover else rng.uniform(0.08, 0.6))
    size, spread = np.array([width, height]), rng.choice([0.12, 0.3])
    middle = rng.normal(0, spread, 2) * size * (1, 0.7) if is_mover else rng.uniform(-0.5, 0.5, 2) * size
    corner = size / 2 + MARGIN
    place = Place(setting.canvas, middle + corner, radius)
    parts = (draw_mover if is_mover else draw_decoy)(rng, place)
    parts = [part._replace(pivot=part.pivot - corner) for part in parts]
    base = np.array([[[middle[0], middle[1] + radius]]], np.float32)
    ground = float(sample_canvas(setting.inverse_depth, base, setting.shape)[0, 0])
    depth = min(ground + abs(rng.normal(0, 0.08)) + (rng.random() < 0.2) * rng.uniform(0, 0.5), 1.5)
    own = None
    if is_mover:
        at = np.array([middle], np.float32)
        carried = camera_flow(setting.camera[1], np.array([depth], np.float32), at, float(max(setting.shape)))[0]
        own = draw_own_motion(rng, middle, radius, carried.astype(float), setting.canvas)
    layers = _shadow(setting, place, depth, own) if rng.random() < 0.2 else []
    texture, chart = _texture(setting), _chart(rng)
    for part in parts:
        if rng.random() < 0.3:
            texture, chart = _texture(setting), _chart(rng)
        layers.append(_part_layer(setting, part, depth, own, texture, chart))
    return depth, layers


def _part_layer(
    setting: _Setting, part: Part, depth: float, own: OwnMotion | None, texture: np.ndarray, chart: np.ndarray
) -> Layer:
    rng = setting.rng
    swing = part.swing * rng.normal() if own is not None else 0.0
    swings = np.array([-swing, swing])
    displacement = displacement_of(part, depth, own, swings, setting.camera, setting.shape)
    if own is None:
        return Layer(part.alpha, displacement, texture, chart)
    speed = _speed(setting, own)
    return Layer(part.alpha, displacement, texture, chart, float(speed > _NOTHING), not _NOTHING < speed < _CERTAIN)


def _speed(setting: _Setting, own: OwnMotion) -> float:
    """Return the larger own displacement of a thing's middle over both steps, px."""
    at = own.middle.astype(np.float32)[None, None]
    moved = [own_displacement(own._replace(foot=None), index, at, setting.shape, None, 0.0)[0, 0] for index in (0, 1)]
    return float(max(np.hypot(*vector) for vector in moved))


def _shadow(setting: _Setting, place: Place, depth: float, own: OwnMotion | None) -> list[Layer]:
    """Draw the shadow of a thing on the ground: it moves with the thing and counts as static."""
    rng = setting.rng
    alpha = np.zeros(setting.canvas, np.uint8)
    middle = place.middle + place.radius * np.array([rng.normal(0, 0.4), 1.0])
    axes = (max(1, int(place.radius * rng.uniform(0.6, 1.6))), max(1, int(place.radius * rng.uniform(0.1, 0.35))))
    cv2.ellipse(alpha, (int(middle[0]), int(middle[1])), axes, rng.normal(0, 8), 0, 360, 255, -1, cv2.LINE_AA)
    alpha = cv2.GaussianBlur(alpha, (0, 0), rng.uniform(0.5, 4))
    displacement = displacement_of(None, depth, own, np.zeros(2), setting.camera, setting.shape)
    return [Layer(alpha, displacement, setting.textures[0], np.eye(2, 3), shade=rng.uniform(0.2, 0.7))]


def _texture(setting: _Setting) -> np.ndarray:
    return setting.textures[setting.rng.integers(len(setting.textures))]


def _chart(rng: np.random.Generator) -> np.ndarray:
    """Draw the place, angle and scale of a texture on a layer."""
    angle, scale = rng.uniform(0, 2 * np.pi), 0.25 * 5 ** rng.random()
    cosine, sine = scale * np.cos(angle), scale * np.sin(angle)
    return np.array([[cosine, -sine, rng.uniform(0, 256)], [sine, cosine, rng.uniform(0, 256)]])
