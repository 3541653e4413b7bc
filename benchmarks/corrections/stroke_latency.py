"""Time from a stroke or a click to its labels, for a video that is open.

Run ``python benchmarks/corrections/stroke_latency.py VIDEO [--end 80] [--store FOLDER] [--out FILE]``. What the store
lacks of the video is computed first, which takes as long as `moseg segment --keep-cues`. Then each kind of edit is made
`--repeats` times, each time at another place, and the labels of its frame are read after it, as a page does. Printed,
and written as JSON, are seconds on the wall (median and largest) and of the processor.
"""

import argparse
import json
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from moseg.workflows.api.open_run import OpenVideo, open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.frame_range import read_frame_range

NEW = 60_000
"""Number of an object that no result has."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("video")
    parser.add_argument("--end", default="80", help="frames of the video")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--store", default=None, help="default: one that is removed")
    parser.add_argument("--out", type=Path, default=None, help="JSON file of the figures")
    options = parser.parse_args()
    chosen = read_frame_range(None, options.end, None)
    with tempfile.TemporaryDirectory(prefix="moseg-bench-") as scratch:
        settings = RunSettings(options.store or scratch, quiet=True)
        with open_run(options.video, settings, chosen=chosen) as video:
            video.apply([])
            rows = {name: _measure(video, edits) for name, edits in _edits(video, options.repeats).items()}
            about = {
                "video": Path(options.video).name,
                "frames": video.num_frames,
                "size": f"{video.analysed_shape[1]}x{video.analysed_shape[0]}",
                "processors": os.cpu_count(),
                "load of the machine, last minute": round(os.getloadavg()[0], 1),
            }
    for name, row in rows.items():
        print(f"{name:12}" + "  ".join(f"{key} {value}" for key, value in row.items()))
    if options.out is not None:
        how = "benchmarks/corrections/stroke_latency.py VIDEO"
        found = {
            "name": options.out.stem,
            "provenance": "measured apart",
            "how": how,
            "result": {**about, "edits": rows},
        }
        options.out.write_text(json.dumps(found, indent=1) + "\n")
    return 0


def _edits(video: OpenVideo, repeats: int) -> dict[str, list[dict[str, Any]]]:
    """Return edits of each kind, on objects in the middle of the video; no two have the same key."""
    height, width = video.shape
    # Other places in every run, so that a store that is kept has none of them.
    offset = time.time() % 1
    frame = video.num_frames // 2
    places = [(width * (0.3 + 0.05 * index) + offset, height * 0.55) for index in range(repeats)]
    strokes, others = (
        [[{"radius": radius, "points": [[x, y], [x + 20, y + 30]]}] for x, y in places] for radius in (12, 13)
    )
    return {
        "paint": [{"paint": {"object": NEW, "frame": frame, "strokes": each}} for each in strokes],
        "erase": [{"erase": {"frame": frame, "strokes": each}} for each in others],
        "add": [{"add": {"object": NEW, "frame": frame, "points": [each]}} for each in places],
    }


def _measure(video: OpenVideo, edits: list[dict[str, Any]]) -> dict[str, float]:
    walls, processor, frames = [], [], []
    for edit in edits:
        started, before = time.perf_counter(), time.process_time()
        frames.append(len(video.apply([edit]).frames))
        (value,) = edit.values()
        video.labels(value["frame"])
        walls.append(time.perf_counter() - started)
        processor.append(time.process_time() - before)
    return {
        "wall, median": round(statistics.median(walls), 2),
        "wall, largest": round(max(walls), 2),
        "processor, median": round(statistics.median(processor), 2),
        "frames, median": statistics.median(frames),
    }


if __name__ == "__main__":
    sys.exit(main())
