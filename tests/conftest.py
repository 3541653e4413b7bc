"""A tiny data set on disk, and a store in which it was evaluated once."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest

NUM_FRAMES, HEIGHT, WIDTH = 10, 96, 128


def write_png(path: Path, image: np.ndarray) -> None:
    """Write an image, RGB where it has three channels."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(cv2.imencode(".png", image[..., ::-1] if image.ndim == 3 else image)[1].tobytes())


def write_squares(folder: Path, seed: int = 0) -> None:
    """A sequence below `folder`: two textured squares that move each in its way over a panning textured background."""
    rng = np.random.default_rng(seed)

    def texture(height, width):
        return cv2.GaussianBlur(rng.integers(0, 256, (height, width, 3)).astype(np.uint8), (0, 0), 1.2) // 2 + 60

    backdrop, squares = texture(HEIGHT, WIDTH + 2 * NUM_FRAMES), (texture(26, 26) + 40, texture(22, 30) + 60)
    for number in range(NUM_FRAMES):
        image = backdrop[:, number : number + WIDTH].copy()
        labels = np.zeros((HEIGHT, WIDTH), np.uint8)
        corners = ((12, 14 + 3 * number), (28 + 3 * number, 84 - number))
        for label, ((y, x), square) in enumerate(zip(corners, squares, strict=True), start=1):
            height, width = square.shape[:2]
            image[y : y + height, x : x + width] = square
            labels[y : y + height, x : x + width] = label
        write_png(folder / "frames" / f"{number:05d}.png", image)
        write_png(folder / "masks" / f"{number:05d}.png", labels)
