"""Folder of many small videos with ground truth."""

from pathlib import Path

import cv2
import numpy as np


def write_videos(root: Path, num_videos: int, num_pairs: int, size: tuple[int, int]) -> None:
    """Write videos of so many frame pairs each: a textured square oscillates over a panning backdrop.

    Parameters
    ----------
    root : path
        Folder for ``<video>/frames/*.png`` and ``<video>/masks/*.png``.
    size : (int, int)
        Height and width of the frames, px.
    """
    height, width = size
    side = min(height, width) // 3
    for video in range(num_videos):
        # Each video has its own texture, because equal frames of two videos would be one artifact.
        rng = np.random.default_rng(video)
        folders = [root / f"video-{video:05}" / name for name in ("frames", "masks")]
        for folder in folders:
            folder.mkdir(parents=True)
        backdrop, square = _texture(rng, height, 3 * width), _texture(rng, side, side)
        for t in range(num_pairs + 1):
            y, x = (round((extent - side) * (0.5 + 0.45 * np.sin(t / 7 + extent + video))) for extent in size)
            image, mask = np.roll(backdrop, -t, axis=1)[:, :width].copy(), np.zeros(size, np.uint8)
            image[y : y + side, x : x + side] = square
            mask[y : y + side, x : x + side] = 255
            for folder, pixels in zip(folders, (image, mask), strict=True):
                if not cv2.imwrite(str(folder / f"{t:06}.png"), pixels):
                    raise OSError(f"cannot write to {folder}")


def _texture(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    noise = rng.integers(0, 256, (height, width, 3)).astype(np.uint8)
    return cv2.GaussianBlur(noise, (0, 0), 1.5)
