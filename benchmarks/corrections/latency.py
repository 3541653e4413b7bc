"""Time from a correction to its labels, for a video that is open.

Run ``python benchmarks/corrections/latency.py VIDEO [--end 80] [--store FOLDER] [--out FILE]``. What the store lacks of
the video is computed first, which takes as long as `moseg segment --keep-cues`. Then each kind of change is made
`--repeats` times, each time with a value that the store does not have, and the labels of the frame in the middle are
read after it, as a page does. Printed, and written as JSON, are seconds on the wall (median and largest) and of the
processor, all threads of this process together.
"""

import argparse
import json
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from moseg.workflows.api.open_run import OpenVideo, open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.frame_range import read_frame_range

LIMIT_SEC = 0.2
"""Wall time within which a result follows a slider."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("video")
    parser.add_argument("--end", default="80", help="frames of the video")
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--store", default=None, help="default: one that is removed")
    parser.add_argument("--out", type=Path, default=None, help="JSON file of the figures")
    options = parser.parse_args()
    chosen = read_frame_range(None, options.end, None)
    with tempfile.TemporaryDirectory(prefix="moseg-bench-") as scratch:
        settings = RunSettings(options.store or scratch, quiet=True)
        with open_run(options.video, settings, chosen=chosen) as video:
            started = time.perf_counter()
            first = video.apply([])
            opened = time.perf_counter() - started
            rows = {name: _measure(video, values) for name, values in _changes(video, first, options.repeats).items()}
            size = f"{video.analysed_shape[1]}x{video.analysed_shape[0]}"
            about = {
                "video": Path(options.video).name,
                "frames": video.num_frames,
                "size": size,
                "objects": len(first.found.identities),
                "seconds to open": round(opened, 3),
                "artifacts computed to open": first.num_computed,
                "processors": os.cpu_count(),
                "load of the machine, last minute": round(os.getloadavg()[0], 1),
            }
    for name, row in rows.items():
        print(f"{name:32}" + "  ".join(f"{key} {value}" for key, value in row.items()))
    if options.out is not None:
        options.out.write_text(json.dumps({**about, "changes": rows}, indent=2) + "\n")
    return 0 if all(row["wall, median"] <= LIMIT_SEC for row in rows.values()) else 1


def _changes(video: OpenVideo, first: Any, repeats: int) -> dict[str, Iterator[Any]]:
    """Return corrections of each kind; no two have the same key."""
    # Other values in every run, so that a store that is kept has none of them.
    offset = time.time() % 1 / 1000
    (identity, *_) = first.found.identities
    frames = [1 + index * (video.num_frames - 2) // repeats for index in range(repeats)]

    def settings(name: str, value: Callable[[int], Any]) -> list[dict]:
        return [{"settings": {name: value(index)}} for index in range(repeats)]

    return {
        "clustering.threshold": settings("clustering.threshold", lambda index: 0.2 + 0.04 * index + offset),
        "clustering.motions": settings("clustering.motions", lambda index: 1 + index % 3),
        "affinity.scale": settings("affinity.scale", lambda index: 0.3 + 0.05 * index + offset),
        "affinity.excess": [
            {"settings": {"affinity.excess": index % 2 == 0, "affinity.scale": 0.4 + 0.01 * index + offset}}
            for index in range(repeats)
        ],
        "moving_objects.min_area": settings("moving_objects.min_area", lambda index: 0.001 + 0.005 * index + offset),
        "drop, keep": [[{"drop": identity}, {"keep": identity}][: 1 + index % 2] for index in range(repeats)],
        "static, moving": [[{"static": identity}, {"moving": identity}][: 1 + index % 2] for index in range(repeats)],
        "split": [[{"split": {"object": identity, "frame": frame}}] for frame in frames],
        "rename": [[{"rename": {"object": identity, "name": f"name {index}"}}] for index in range(repeats)],
    }


def _measure(video: OpenVideo, changes: list[Any]) -> dict[str, float]:
    walls, processor, computed = [], [], []
    for change in changes:
        started, before = time.perf_counter(), time.process_time()
        computed.append(video.apply(change).num_computed)
        video.labels(video.num_frames // 2)
        walls.append(time.perf_counter() - started)
        processor.append(time.process_time() - before)
    return {
        "wall, median": round(statistics.median(walls), 4),
        "wall, largest": round(max(walls), 4),
        "processor, median": round(statistics.median(processor), 4),
        "artifacts, median": statistics.median(computed),
    }


if __name__ == "__main__":
    sys.exit(main())
