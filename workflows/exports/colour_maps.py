"""Numbers as colours of evenly increasing lightness, so that a picture can be read without colour."""

import cv2
import numpy as np

SOFT_COLOURS = cv2.COLORMAP_INFERNO
"""Of soft maps: black over red to yellow."""
DEPTH_COLOURS = cv2.COLORMAP_VIRIDIS
"""Of inverse depth: violet over green to yellow, distinct from soft maps."""


def colour_soft_map(soft_map: np.ndarray) -> np.ndarray:
    """Return the colours of values 0..1, the same in every frame and sequence, uint8 (y, x, rgb)."""
    return _colour(soft_map, SOFT_COLOURS)


def colour_inverse_depth(inverse_depth: np.ndarray, farthest: float, nearest: float) -> np.ndarray:
    """Return the colours of inverse depth between two values, uint8 (y, x, rgb); the nearer, the lighter."""
    extent = nearest - farthest
    shares = (inverse_depth - farthest) / extent if extent > 0 else np.zeros_like(inverse_depth)
    return _colour(shares, DEPTH_COLOURS)


def draw_colour_bar(shape: tuple[int, int], colours: int) -> np.ndarray:
    """Draw the colours of a map from its smallest value, left, to its largest, uint8 (y, x, rgb) of a `shape`."""
    height, width = shape
    return _colour(np.tile(np.linspace(0, 1, width, dtype=np.float32), (height, 1)), colours)


def _colour(shares: np.ndarray, colours: int) -> np.ndarray:
    levels = np.rint(255 * np.clip(shares, 0, 1)).astype(np.uint8)
    return cv2.cvtColor(cv2.applyColorMap(levels, colours), cv2.COLOR_BGR2RGB)
