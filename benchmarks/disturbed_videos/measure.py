"""Scores on disturbed videos: ``python benchmarks/disturbed_videos/measure.py ROOT [--dataset davis16|kt3dinsmoseg]
[--sequences A,B] [--workers N] [--disturbances NAME ...] [--config FILE] [--json FILE]``.

Each sequence is changed in several ways, with its ground truth, and segmented.
What differs between a sequence and its mirror image is chance; what is lost beyond that tells what the method relies
on.
"""

import argparse
import json
import tempfile
import zlib
from pathlib import Path

import numpy as np
from disturbances import DISTURBANCES
from layouts import LAYOUTS, Layout

import moseg


def measure(
    layout: Layout, root: Path, sequences: list[str], name: str, workers: int, config: Path | None
) -> dict[str, dict[str, float]]:
    """Return J and Fu of each disturbed sequence, and their means, in percent."""
    with tempfile.TemporaryDirectory() as folder:
        disturbed = Path(folder, layout.name)
        for sequence in sequences:
            rng = np.random.default_rng(zlib.crc32(sequence.encode()))
            layout.write(disturbed, sequence, DISTURBANCES[name][1](layout.read(root, sequence), rng))
        store = Path(folder, "store")
        report = moseg.evaluate(
            layout.name,
            root=disturbed,
            sequences=sequences,
            config=config,
            store=store,
            workers=workers,
            progress=False,
        )
    (row,) = report.rows
    scores = {sequence: {"J": each.J, "F": each.F} for sequence, each in row.sequences.items()}
    return {**scores, "mean": {"J": row.mean.J, "F": row.mean.F}}


def main() -> None:
    """Measure and print all that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=Path, metavar="ROOT", help="folder of the data set")
    parser.add_argument("--dataset", choices=LAYOUTS, default="davis16")
    parser.add_argument("--sequences", type=lambda names: names.split(","), help="names, separated by commas")
    parser.add_argument("--disturbances", nargs="+", choices=DISTURBANCES, help="default: all that suit the data set")
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--config", type=Path, help="parameters, as of moseg eval")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    layout = LAYOUTS[asked.dataset]
    sequences = asked.sequences or layout.sequences(asked.root)
    found = {}
    for name in asked.disturbances or layout.disturbances or DISTURBANCES:
        found[name] = measure(layout, asked.root, sequences, name, asked.workers, asked.config)
        figures = "  ".join(f"{sequence} {each['J']:.1f}" for sequence, each in found[name].items())
        print(f"{DISTURBANCES[name][0]}: J {figures}; Fu {found[name]['mean']['F']:.1f}", flush=True)
        if asked.json:
            asked.json.write_text(json.dumps({"videos": found}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
