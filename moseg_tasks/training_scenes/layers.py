"""Layers of a scene: a texture under a mask that moves from the middle frame to its neighbours."""

from collections.abc import Callable
from typing import NamedTuple

import cv2
import numpy as np

MARGIN = 48
"""Width of the canvas beyond the frame on each side, px."""
_COARSE = 4  # px between the points at which motion is inverted
_ROUNDS = 4  # of the inversion of a displacement by fixed-point iteration

Displacement = Callable[[int, np.ndarray], np.ndarray]
"""Displacement float32 (..., 2) px to frame -1 or 1 of points float32 (..., 2), xy from the middle of the frame."""


class Layer(NamedTuple):
    """A layer.

    Attributes
    ----------
    alpha : uint8 (canvas y, canvas x) or None
        Coverage in the middle frame; None covers everything.
    displacement : Displacement
    texture : uint8 (side, side, 3)
    chart : float64 (2, 3)
        Texel of a point: ``chart @ (x, y, 1)``.
    moves : float
        Label: 1 moves on its own, 0 static.
    counts : bool
        Whether the label is certain enough to train on.
    shade : float
        If positive, the layer darkens what is behind it by this share and has no label.
    """

    alpha: np.ndarray | None
    displacement: Displacement
    texture: np.ndarray
    chart: np.ndarray
    moves: float = 0.0
    counts: bool = True
    shade: float = 0.0


class Canvas(NamedTuple):
    """Three frames float32 (3, y, x, 3) in the making, label and its weight float32 (y, x) of the middle one."""

    frames: np.ndarray
    label: np.ndarray
    weight: np.ndarray


def canvas_points(shape: tuple[int, int], margin: int = MARGIN, step: int = 1) -> np.ndarray:
    """Return the points float32 (y, x, 2) of every `step`-th pixel of a frame of `shape` with a margin."""
    height, width = shape
    y = np.arange(-margin, height + margin, step, dtype=np.float32) - height / 2
    x = np.arange(-margin, width + margin, step, dtype=np.float32) - width / 2
    return np.stack(np.meshgrid(x, y), axis=-1)


def empty_canvas(shape: tuple[int, int]) -> Canvas:
    """Return black frames without a label."""
    return Canvas(np.zeros((3, *shape, 3), np.float32), np.zeros(shape, np.float32), np.ones(shape, np.float32))


def add_layer(canvas: Canvas, layer: Layer) -> None:
    """Draw a layer over what the canvas shows already."""
    shape = canvas.label.shape
    for index in range(3):
        window = _window(layer, index - 1, shape)
        if window is None:
            continue
        origin = _origin_points(layer.displacement, index - 1, window, shape)
        alpha = _coverage(layer, origin, shape)
        frame = canvas.frames[index][window]
        if layer.shade:
            frame *= 1 - layer.shade * alpha[..., None]
            continue
        chart = layer.chart.astype(np.float32)
        colours = cv2.remap(
            layer.texture, cv2.transform(origin, chart), None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP
        )
        frame += alpha[..., None] * (colours - frame)
        if index == 1:
            for target, value in ((canvas.label, layer.moves), (canvas.weight, float(layer.counts))):
                target[window] += alpha * (np.float32(value) - target[window])


def sample_canvas(image: np.ndarray, points: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Sample an image of the canvas at points from the middle of the frame, replicated beyond the canvas."""
    offset = np.array([shape[1] / 2 + MARGIN, shape[0] / 2 + MARGIN], np.float32)
    return cv2.remap(image, points + offset, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def _coverage(layer: Layer, origin: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    if layer.alpha is None:
        return np.ones(origin.shape[:2], np.float32)
    return sample_canvas(layer.alpha, origin, shape).astype(np.float32) / 255


def _window(layer: Layer, step: int, shape: tuple[int, int]) -> tuple[slice, slice] | None:
    """Return the part of a frame in which the layer may be seen; None if there is none."""
    height, width = shape
    if layer.alpha is None:
        return slice(0, height), slice(0, width)
    x, y, w, h = cv2.boundingRect(layer.alpha)
    if w == 0 or h == 0:
        return None
    corners = np.array([[x, y], [x + w, y], [x, y + h], [x + w, y + h], [x + w / 2, y + h / 2]], np.float32)
    half = np.array([width / 2, height / 2], np.float32)
    corners -= half + MARGIN
    if step:
        corners = corners + layer.displacement(step, corners[None])[0]
    low = np.floor(corners.min(0) + half).astype(int) - 6
    high = np.ceil(corners.max(0) + half).astype(int) + 6
    (left, top), (right, bottom) = np.clip(low, 0, (width, height)), np.clip(high, 0, (width, height))
    return (slice(top, bottom), slice(left, right)) if bottom > top and right > left else None


def _origin_points(displacement: Displacement, step: int, window, shape: tuple[int, int]) -> np.ndarray:
    """Return where the pixels of a window of frame `step` come from in the middle frame, float32 (y, x, 2)."""
    height, width = shape
    rows, columns = window
    if step == 0:
        return np.ascontiguousarray(canvas_points(shape, 0)[window])
    tall, wide = rows.stop - rows.start, columns.stop - columns.start
    y = np.linspace(rows.start, rows.stop - 1, max(2, -(-tall // _COARSE)), dtype=np.float32) - height / 2
    x = np.linspace(columns.start, columns.stop - 1, max(2, -(-wide // _COARSE)), dtype=np.float32) - width / 2
    seen = np.stack(np.meshgrid(x, y), axis=-1)
    origin = seen
    for _ in range(_ROUNDS):
        origin = seen - displacement(step, origin)
    # Corners of the coarse points are those of the window: bilinear interpolation between them.
    at_y = np.linspace(0, len(y) - 1, tall, dtype=np.float32)
    at_x = np.linspace(0, len(x) - 1, wide, dtype=np.float32)
    return cv2.remap(origin, *np.meshgrid(at_x, at_y), cv2.INTER_LINEAR)
