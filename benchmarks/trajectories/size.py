"""Time and memory of grouping trajectories, by the numbers of frames and of trajectories.

``python benchmarks/trajectories/size.py [--cases NAME ...] [--json FILE]`` groups synthetic trajectories of a static
scene and two moving bodies with the default parameters, each case in a process of its own. Seconds are of the
processor, without imports; the peak is that of the process. The error is in percent, with the number of motions found.
"""

import argparse
import json
import os
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig
from moseg.tasks.metrics import clustering_error

SHARES = (0.6, 0.25, 0.15)
"""Of the trajectories on the static scene and on each moving body."""
FOCAL, CENTRE = 800.0, (640.0, 360.0)
"""px."""
NOISE = 0.1
"""px."""


class Size(NamedTuple):
    """Size of a clip: trajectories, frames, and frames in which one trajectory is visible."""

    num_tracks: int
    num_frames: int
    length: int


CASES = {
    "2 frames": Size(400, 2, 2),
    "5 frames": Size(400, 5, 5),
    "25 frames": Size(400, 25, 25),
    "100 frames": Size(400, 100, 100),
    "1000 frames": Size(400, 1000, 1000),
    "1000 frames, short tracks": Size(4000, 1000, 30),
    "1000 tracks": Size(1000, 25, 25),
    "3000 tracks": Size(3000, 25, 25),
    "10000 tracks": Size(10000, 25, 25),
    "20000 tracks": Size(20000, 25, 25),
}


def make_clip(size: Size, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points (N, F, 2), px, visibility (N, F) and labels (N,) of rigid bodies before a moving camera."""
    rng = np.random.default_rng(seed)
    labels = rng.choice(len(SHARES), size.num_tracks, p=SHARES)
    centres = np.array([[0, 0, 20], [-4, 1, 14], [4, -1, 12]], dtype=float)
    extents = np.array([[10, 5, 8], [1.5, 1, 1.5], [1.5, 1, 1.5]])
    body = rng.uniform(-1, 1, (size.num_tracks, 3)) * extents[labels]
    # Each motion oscillates, so that a clip of any length stays in view; the camera moves too.
    phase = np.sin(np.arange(size.num_frames)[:, None] * 0.08 + np.arange(3))
    drift = np.array([[0.0, 0, 0], [1.2, 0.1, 0.8], [-0.6, 0.3, 1.5]])
    turn = np.array([0.0, 0.15, -0.2])
    points = np.empty((size.num_tracks, size.num_frames, 2))
    for frame in range(size.num_frames):
        angle = (turn * phase[frame, 1])[labels]
        x = body[:, 0] * np.cos(angle) + body[:, 2] * np.sin(angle)
        z = body[:, 2] * np.cos(angle) - body[:, 0] * np.sin(angle)
        world = np.stack([x, body[:, 1], z], axis=1) + (centres + drift * phase[frame, 0])[labels]
        camera = world - np.array([1.5 * phase[frame, 2], 0.2 * phase[frame, 1], 1.2 * phase[frame, 0]])
        points[:, frame] = FOCAL * camera[:, :2] / camera[:, 2:] + CENTRE
    points += rng.normal(0, NOISE, points.shape)
    first = rng.integers(size.num_frames - size.length + 1, size=size.num_tracks)[:, None]
    frames = np.arange(size.num_frames)
    return points, (frames >= first) & (frames < first + size.length), labels


def measure(size: Size) -> dict[str, float]:
    """Return the cost and the error of one clip; runs in a process of its own."""
    from segment_tracks import segment_tracks

    clip = make_clip(Size(60, 4, 4))
    segment_tracks(*clip[:2], 2, PipelineConfig())
    points, visible, labels = make_clip(size)
    started = time.process_time()
    found = segment_tracks(points, visible, None, PipelineConfig())
    return {
        **size._asdict(),
        "seconds": time.process_time() - started,
        "peak_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "error": float(clustering_error(found.motion, labels)),
        "num_motions": found.clustering.num_motions,
    }


def main() -> None:
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", nargs="+", choices=tuple(CASES), default=tuple(CASES), metavar="NAME")
    parser.add_argument("--json", type=Path, help="write the figures here too")
    options = parser.parse_args()
    found = {}
    print(f"{'case':28} {'CPU s':>8} {'peak MiB':>9} {'error':>6} {'motions':>8}")
    for name in options.cases:
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            found[name] = each = pool.submit(measure, CASES[name]).result()
        figures = f"{each['seconds']:8.1f} {each['peak_mib']:9.0f} {each['error']:6.1f} {each['num_motions']:8d}"
        print(f"{name:28} {figures}", flush=True)
    if options.json is not None:
        options.json.write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
