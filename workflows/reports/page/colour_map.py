"""Colours of matrices: a perceptually uniform scale in a fixed number of steps."""

import functools

import cv2
import numpy as np

NUM_STEPS = 64


@functools.cache
def _colours() -> np.ndarray:
    """Viridis; uint8 (NUM_STEPS, 3), RGB."""
    grey = np.linspace(0, 255, NUM_STEPS).round().astype(np.uint8)
    return np.ascontiguousarray(cv2.applyColorMap(grey[:, None], cv2.COLORMAP_VIRIDIS)[:, 0, ::-1])


def _is_light(rgb: np.ndarray) -> bool:
    """Whether black reads better than white on a colour, by the relative luminance of WCAG 2."""
    channel = rgb / 255
    linear = np.where(channel <= 0.04045, channel / 12.92, ((channel + 0.055) / 1.055) ** 2.4)
    return bool(linear @ (0.2126, 0.7152, 0.0722) > 0.179)


def colour_map_style() -> str:
    """CSS: a class ``vN`` for each step, and the scale as a gradient in ``.scale``."""
    names = ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in _colours()]
    rules = [
        f".v{step}{{background:{name};color:{'#000' if _is_light(rgb) else '#fff'}}}"
        for step, (name, rgb) in enumerate(zip(names, _colours(), strict=True))
    ]
    return "\n".join([*rules, f".scale{{background:linear-gradient(to right,{','.join(names)})}}"])


def steps_of(positions: np.ndarray) -> np.ndarray:
    """Steps of positions on the scale, 0..1; int64 of the same shape, -1 for NaN."""
    steps = np.clip(np.nan_to_num(positions) * NUM_STEPS, 0, NUM_STEPS - 1).astype(np.int64)
    return np.where(np.isnan(positions), -1, steps)


def paint(positions: np.ndarray) -> np.ndarray:
    """RGBA of positions on the scale; uint8 (*shape, 4), transparent for NaN."""
    steps = steps_of(positions)
    alpha = np.where(steps < 0, 0, 255).astype(np.uint8)
    return np.concatenate([_colours()[np.maximum(steps, 0)], alpha[..., None]], axis=-1)
