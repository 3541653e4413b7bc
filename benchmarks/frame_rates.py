"""Scores of rendered drives at several frame rates: ``python benchmarks/frame_rates.py [--workers N] [--json FILE]``.

The drives of the synthetic data set are KITTI's: ten frames a second. Here they go on at the same speed in more frames
of KITTI's full size, and are segmented like a user's own sequences, with the default frame pairs and with pairs as many
seconds apart as at ten frames a second.
"""

import argparse
import json
import tempfile
from pathlib import Path

import cv2
import numpy as np
from pydantic import BaseModel

import moseg
from moseg.schemas.parameters import RigidityParams
from moseg.tasks.synthetic import SCENES, Scene, render_scene
from moseg.tasks.synthetic.paths import Path as MotionPath

DRIVES = tuple(name for name in SCENES if name.startswith("drive-"))
RATES = (10, 20, 30)
"""Frames per second."""
GAPS = RigidityParams().gaps
"""Default distances of the frames of a pair."""
FULL_SIZE = {"height": 376, "width": 1244}


def main() -> None:
    """Measure and print the scores of all drives at all frame rates."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    found = {}
    for rate in RATES:
        factor = rate // RATES[0]
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder, "drives")
            for name in DRIVES:
                write_sequence(root / name, slowed(SCENES[name], factor))
            for kind, gaps in {"frames": GAPS, "seconds": [factor * gap for gap in GAPS]}.items():
                report = moseg.evaluate(
                    "folder",
                    {"rigidity": {"gaps": list(gaps)}},
                    root=root,
                    motions="auto",
                    store=Path(folder, "store"),
                    workers=asked.workers,
                    progress=False,
                )
                (row,) = report.rows
                scores = {name: {"J": each.J, "F": each.F} for name, each in row.sequences.items()}
                found.setdefault(kind, {})[f"rate-{rate}"] = scores
                figures = "  ".join(f"{name} {each['J']:.1f}" for name, each in scores.items())
                print(f"{rate} frames per second, pairs {gaps} apart: J {figures}", flush=True)
    if asked.json is not None:
        asked.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def slowed(scene: Scene, factor: int) -> Scene:
    """Return the same motion in `factor` times the frames, at KITTI's full size."""
    return _slowed(scene, factor).model_copy(update={"num_frames": factor * scene.num_frames, **FULL_SIZE})


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


def write_sequence(folder: Path, scene: Scene) -> None:
    """Render a scene's frames and the masks of what moves in it, in the layout of a user's sequences."""
    rendered = render_scene(scene)
    for kind in ("frames", "masks"):
        (folder / kind).mkdir(parents=True)
    for number, (image, moving) in enumerate(zip(rendered.images, rendered.moving, strict=True)):
        cv2.imwrite(str(folder / "frames" / f"{number:05}.png"), cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
        cv2.imwrite(str(folder / "masks" / f"{number:05}.png"), moving.astype(np.uint8))


if __name__ == "__main__":
    main()
