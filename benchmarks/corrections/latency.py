"""Time from a correction to its labels, for videos that are open.

Run ``python benchmarks/corrections/latency.py VIDEO… [--end 80] [--store FOLDER] [--out FILE]``. What the store lacks
of the videos is computed first, which takes as long as `moseg segment --keep-cues`. Then each kind of change is made
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
from collections.abc import Callable
from pathlib import Path
from typing import Any

from moseg.workflows.api.open_run import OpenVideo, open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.frame_range import read_frame_range
from moseg.workflows.pipelines.correct import Change

LIMIT_SEC = 0.2
"""Wall time within which a result follows a slider."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("videos", nargs="+", metavar="VIDEO")
    parser.add_argument("--end", default="80", help="frames of each video")
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--store", default=None, help="default: one that is removed")
    parser.add_argument("--out", type=Path, default=None, help="JSON file of the figures")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="moseg-bench-") as scratch:
        settings = RunSettings(options.store or scratch, quiet=True)
        measured = [_measure_video(video, settings, options.end, options.repeats) for video in options.videos]
    machine = {"processors": os.cpu_count(), "load, last minute": round(os.getloadavg()[0], 1)}
    if options.out is not None:
        options.out.write_text(json.dumps({"machine": machine, "videos": measured}, indent=2) + "\n")
    rows = [row for each in measured for row in each["changes"].values()]
    return 0 if all(row["wall, median"] <= LIMIT_SEC for row in rows) else 1


def _measure_video(path: str, settings: RunSettings, end: str, repeats: int) -> dict[str, Any]:
    with open_run(path, settings, chosen=read_frame_range(None, end, None)) as video:
        first = video.apply([])
        about = {
            "video": Path(path).name,
            "frames": video.num_frames,
            "size": f"{video.analysed_shape[1]}x{video.analysed_shape[0]}",
            "objects": len(first.found.identities),
            "seconds to open": round(first.seconds, 3),
            "artifacts computed to open": first.num_computed,
        }
        print(", ".join(f"{name} {value}" for name, value in about.items()))
        rows = {name: _measure(video, changes) for name, changes in _changes(video, first, repeats).items()}
    for name, row in rows.items():
        print(f"  {name:26}" + "  ".join(f"{key} {value}" for key, value in row.items()))
    return {**about, "changes": rows}


def _changes(video: OpenVideo, first: Change, repeats: int) -> dict[str, list[Any]]:
    """Return corrections of each kind; settings have values that no other has, but for the number of motions."""
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
