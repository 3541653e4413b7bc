"""Traces of the camera and of the video file in frames: brightness, contrast, colour, blur, grain, compression."""

import cv2
import numpy as np


def expose(rng: np.random.Generator, frames: np.ndarray) -> np.ndarray:
    """Convert rendered frames float32 (3, y, x, 3), grey levels, to uint8 frames as a camera might have stored them."""
    contrast = rng.uniform(0.3, 1.0) if rng.random() < 0.4 else 1.0
    bias = rng.uniform(0, 255 * (1 - contrast))
    if rng.random() < 0.1:  # too little light
        contrast, bias = rng.uniform(0.08, 0.35), rng.uniform(0, 10)
    if rng.random() < 0.1:  # no colours
        frames = np.broadcast_to(frames.mean(axis=-1, keepdims=True), frames.shape)
    flicker = rng.normal(0, rng.choice([0.0, 0.01, 0.05]), 3)
    blur = rng.uniform(0.3, 1.3) if rng.random() < 0.5 else 0.0
    grain = rng.uniform(0, 6) if rng.random() < 0.7 else 0.0
    quality = int(rng.integers(30, 96)) if rng.random() < 0.6 else None
    return np.stack(
        [
            _store(rng, frame * (contrast * (1 + gain)) + bias, blur, grain, quality)
            for frame, gain in zip(frames, flicker, strict=True)
        ]
    )


def _store(rng: np.random.Generator, frame: np.ndarray, blur: float, grain: float, quality: int | None) -> np.ndarray:
    if blur:
        frame = cv2.GaussianBlur(frame, (0, 0), blur)
    if grain:
        noise = np.empty(frame.shape[:2], np.float32)
        cv2.setRNGSeed(int(rng.integers(2**31)))
        cv2.randn(noise, 0.0, grain)
        frame = frame + noise[..., None]
    stored = np.clip(np.rint(frame), 0, 255).astype(np.uint8)
    if quality is not None:
        _, data = cv2.imencode(".jpg", stored, [cv2.IMWRITE_JPEG_QUALITY, quality])
        stored = cv2.imdecode(data, cv2.IMREAD_COLOR)
    return stored
