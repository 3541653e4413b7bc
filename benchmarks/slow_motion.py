"""Scores of rendered scenes in slow motion: ``python benchmarks/slow_motion.py [--workers N] [--json FILE]``.

Scenes of the synthetic data set, some of which have movers and others not, go on in several times as many frames, with
the noise of a camera, and are coded as H.264. Motion is seen between neighbouring pictures, and between pictures as far
apart as is chosen.
"""

import argparse
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
from slowed_scenes import slowed, write_sequence

import moseg
from moseg.schemas.parameters import SlowMotionParams
from moseg.tasks.synthetic import SCENES, STILL_SCENES

MOVERS = ("handheld-jitter", "occlusion", "slow-mover", "small-fast", "static-camera", "strong-parallax")
FACTORS = (1, 4)
"""Numbers of frames, in multiples of the usual one."""
MAX_GAPS = {"neighbours": 1, "chosen": SlowMotionParams().max_gap}
"""Largest distance of the pictures of a pair."""
NOISE = 4.0
"""Standard deviation of the noise, grey levels."""
CRF = 26


def main() -> None:
    """Measure and print the scores at all speeds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    found: dict[str, dict] = {kind: {} for kind in MAX_GAPS}
    for factor in FACTORS:
        with tempfile.TemporaryDirectory() as folder:
            roots = {group: Path(folder, group) for group in ("movers", "still")}
            for name in MOVERS:
                write_sequence(roots["movers"] / name, slowed(SCENES[name], factor), record)
            for name, scene in STILL_SCENES.items():
                write_sequence(roots["still"] / name, slowed(scene, factor), record)
            for kind, max_gap in MAX_GAPS.items():
                scores = {
                    group: _scores(root, max_gap, Path(folder, "store"), asked.workers) for group, root in roots.items()
                }
                found[kind][f"slower-{factor}"] = scores
                means = ", ".join(f"{group} {each['mean']['J']:.1f}" for group, each in scores.items())
                print(f"{factor} times as many frames, {kind}: J {means}", flush=True)
    if asked.json is not None:
        asked.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def record(images: np.ndarray) -> Iterator[np.ndarray]:
    """Yield frames, uint8 (frame, y, x, 3), with the noise of a camera and after they were coded; the same each time.

    An odd last row or column, which H.264 cannot hold, stays as it was.
    """
    rng = np.random.default_rng(0)
    height, width = (side // 2 * 2 for side in images.shape[1:3])
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "video.mp4"))
        with av.open(path, "w") as container:
            stream = container.add_stream("libx264", rate=30, options={"crf": str(CRF)})
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            for image in images:
                noisy = np.clip(image + rng.normal(0, NOISE, image.shape), 0, 255).astype(np.uint8)
                frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(noisy[:height, :width]))
                container.mux(stream.encode(frame))
            container.mux(stream.encode())
        with av.open(path) as container:
            for image, frame in zip(images, container.decode(video=0), strict=True):
                coded = image.copy()
                coded[:height, :width] = frame.to_ndarray(format="rgb24")
                yield coded


def _scores(root: Path, max_gap: int, store: Path, workers: int) -> dict[str, dict[str, float]]:
    config = {"slow_motion": {"max_gap": max_gap}}
    report = moseg.evaluate("folder", config, root=root, motions="auto", store=store, workers=workers, progress=False)
    (row,) = report.rows
    scores = {name: {"J": each.J, "F": each.F} for name, each in row.sequences.items()}
    return {**scores, "mean": {"J": row.mean.J, "F": row.mean.F}}


if __name__ == "__main__":
    main()
