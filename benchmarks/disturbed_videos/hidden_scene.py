"""Scores of a user's videos with black bars or graphics: ``python benchmarks/disturbed_videos/hidden_scene.py ROOT
[--dataset davis16|kt3dinsmoseg] [--sequences A,B] [--only pillars graphics] [--json FILE]``.

Each sequence is segmented as `segment_video` does it by default: as it is, with pillars, letterboxed, in a 16:9 canvas,
and with a logo and a clock, once with these left out and once with them as scene (``black_bars.fill`` and
``screen_graphics.fill``). The ground truth has no object in the bars, and does not know the graphics. `measure.py` has
the same disturbances, but the sequences of data sets are not searched for them.
"""

import argparse
import json
import tempfile
from pathlib import Path

from disturbances import DISTURBANCES
from layouts import LAYOUTS, Layout

import moseg

HIDING = "none", "pillars", "letterbox", "canvas", "graphics"


def measure(layout: Layout, root: Path, sequence: str, hiding: str, fills: bool) -> dict[str, float]:
    """Return J and Fu of a sequence, in percent."""
    with tempfile.TemporaryDirectory() as folder:
        changed, masks = Path(folder, "changed"), Path(folder, "masks", sequence)
        layout.write(changed, sequence, DISTURBANCES[hiding][1](layout.read(root, sequence), None))
        settings = {"black_bars.fill": fills, "screen_graphics.fill": fills}
        result = moseg.segment_video(
            layout.frames_of(changed, sequence), settings, store=Path(folder, "store"), progress=False
        )
        result.save(Path(folder, "out"))
        masks.parent.mkdir()
        Path(folder, "out", "masks").rename(masks)
        report = moseg.score(masks.parent, layout.name, root=changed, sequences=[sequence], progress=False)
    mean = report.rows[0].mean
    return {"J": mean.J, "F": mean.F}


def main() -> None:
    """Measure and print all that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=Path, metavar="ROOT", help="folder of the data set")
    parser.add_argument("--dataset", choices=LAYOUTS, default="davis16")
    parser.add_argument("--sequences", type=lambda names: names.split(","), help="names, separated by commas")
    parser.add_argument("--only", nargs="+", choices=HIDING, default=HIDING, help="what hides the scene")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    layout = LAYOUTS[asked.dataset]
    sequences = asked.sequences or layout.sequences(asked.root)
    found = {}
    for hiding in asked.only:
        for fills in (True, False) if hiding != "none" else (True,):
            name = hiding if hiding == "none" else f"{hiding}, {'left out' if fills else 'as scene'}"
            scores = {sequence: measure(layout, asked.root, sequence, hiding, fills) for sequence in sequences}
            mean = {key: sum(each[key] for each in scores.values()) / len(scores) for key in ("J", "F")}
            found[name] = {**scores, "mean": mean}
            figures = "  ".join(f"{sequence} {each['J']:.1f}" for sequence, each in found[name].items())
            print(f"{name}: J {figures}; Fu {mean['F']:.1f}", flush=True)
            if asked.json:
                asked.json.write_text(json.dumps({"videos": found}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
