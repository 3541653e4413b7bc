"""Peak memory and time of `moseg segment` on videos of different lengths.

Run ``python benchmarks/long_video/peak_memory.py [--frames 200 1000] [--size 320x180] [-- OPTION ...]``; some two
minutes. A textured square oscillates over a panning backdrop. Each video is segmented by a process of its own with an
empty store, so that the peak is that of a cold run, decoding and overlay included; what follows ``--`` are further
options of `moseg segment`. With ``--workers`` the peak is that of the largest process.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from moseg.workflows.exports.write_overlay import write_overlay

MIB = 2**20
MOSEG = (sys.executable, "-c", "from moseg.workflows.cli import main; main()")


class Cost(NamedTuple):
    """Cost of one run: largest resident memory of a process, bytes, and wall-clock and CPU seconds."""

    peak: int
    wall: float
    cpu: float


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, nargs="+", default=[200, 1000], help="lengths of the videos")
    parser.add_argument("--size", default="320x180", help="width and height of their frames, px")
    parser.add_argument("--root", type=Path, default=None, help="folder for the videos and stores, until the end")
    parser.add_argument("options", nargs="*", help="options of `moseg segment`, after --")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    print("| frames | peak | wall s/frame | CPU s/frame | peak, of the first |\n|---|---|---|---|---|", flush=True)
    first = None
    for num_frames in options.frames:
        cost = measure(num_frames, height, width, options.root, options.options)
        first = first or cost
        seconds = f"{cost.wall / num_frames:.3f} | {cost.cpu / num_frames:.3f}"
        print(f"| {num_frames} | {cost.peak / MIB:.0f} MiB | {seconds} | {cost.peak / first.peak:.2f} |", flush=True)
    return 0


def measure(num_frames: int, height: int, width: int, root: Path | None, options: list[str]) -> Cost:
    """Return the cost of segmenting a video of so many frames."""
    folder = Path(tempfile.mkdtemp(prefix="moseg-bench-", dir=root))
    try:
        video = folder / "video.mp4"
        unlabelled = (np.zeros((height, width), np.uint16) for _ in range(num_frames))
        write_overlay(video, frames(num_frames, height, width), unlabelled, fps=25)
        paths = ("--out", str(folder / "out"), "--store", str(folder / "store"))
        return run([*MOSEG, "segment", str(video), *paths, "--quiet", *options], folder / "printed")
    finally:
        shutil.rmtree(folder)


def frames(num_frames: int, height: int, width: int) -> Iterator[np.ndarray]:
    """Yield the frames uint8 (y, x, 3) of the video."""
    rng = np.random.default_rng(0)
    side = height // 4

    def texture(height, width, brightness):
        noise = rng.integers(0, 256, (height, width, 3)).astype(np.uint8)
        return cv2.GaussianBlur(noise, (0, 0), 2) // 2 + np.uint8(brightness)

    backdrop, square = texture(height, 3 * width, 50), texture(side, side, 110)
    for t in range(num_frames):
        image = np.roll(backdrop, -t, axis=1)[:, :width].copy()
        x, y = (round((extent - side) * (0.5 + 0.4 * np.sin(t / 30 + extent))) for extent in (width, height))
        image[y : y + side, x : x + side] = square
        yield image


def run(command: list[str], printed: Path) -> Cost:
    """Run a command to its end; raises CalledProcessError if it fails."""
    with printed.open("wb") as output:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        # Not `resource.getrusage` of all children, which gives the largest child so far.
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        print(printed.read_text(), file=sys.stderr)
        raise subprocess.CalledProcessError(process.returncode, command)
    # In kilobytes, on macOS in bytes.
    peak = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return Cost(peak, wall, usage.ru_utime + usage.ru_stime)


if __name__ == "__main__":
    sys.exit(main())
