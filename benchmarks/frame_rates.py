"""Scores of rendered drives at several frame rates: ``python benchmarks/frame_rates.py [--workers N] [--json FILE]``.

The drives of the synthetic data set are KITTI's: ten frames a second. Here they go on at the same speed in more frames
of KITTI's full size, and are segmented like a user's own sequences, with the default frame pairs and with pairs as many
seconds apart as at ten frames a second.
"""

import argparse
import json
import tempfile
from pathlib import Path

from slowed_scenes import slowed, write_sequence

import moseg
from moseg.schemas.parameters import RigidityParams
from moseg.tasks.synthetic import SCENES

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
                write_sequence(root / name, slowed(SCENES[name], factor).model_copy(update=FULL_SIZE))
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


if __name__ == "__main__":
    main()
