"""Scenes of the synthetic data set that go on at the same speed in more frames, as files that a run reads."""

from collections.abc import Callable, Iterable
from pathlib import Path

import cv2
import numpy as np
from pydantic import BaseModel

from moseg.tasks.synthetic import Scene, render_scene
from moseg.tasks.synthetic.paths import Path as MotionPath


def slowed(scene: Scene, factor: int) -> Scene:
    """Return the same motion in `factor` times the frames."""
    return _slowed(scene, factor).model_copy(update={"num_frames": factor * scene.num_frames})


def _slowed(part, factor: int):
    if isinstance(part, MotionPath):
        velocity = tuple(speed / factor for speed in part.velocity)
        sways = tuple(sway.model_copy(update={"period": factor * sway.period}) for sway in part.sways)
        return part.model_copy(update={"velocity": velocity, "sways": sways})
    if isinstance(part, BaseModel):
        return part.model_copy(update={name: _slowed(value, factor) for name, value in part})
    if isinstance(part, tuple):
        return tuple(_slowed(each, factor) for each in part)
    return part


def write_sequence(folder: Path, scene: Scene, record: Callable[[np.ndarray], Iterable[np.ndarray]] = iter) -> None:
    """Render a scene's frames and the masks of what moves in it, in the layout of a user's sequences.

    `record` returns what a camera and a video file make of the frames, uint8 (frame, y, x, 3).
    """
    rendered = render_scene(scene)
    for kind in ("frames", "masks"):
        (folder / kind).mkdir(parents=True)
    for number, (image, moving) in enumerate(zip(record(rendered.images), rendered.moving, strict=True)):
        cv2.imwrite(str(folder / "frames" / f"{number:05}.png"), cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
        cv2.imwrite(str(folder / "masks" / f"{number:05}.png"), moving.astype(np.uint8))
