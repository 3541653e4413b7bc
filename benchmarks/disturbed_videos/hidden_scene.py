"""Scores of a user's videos with black bars or graphics: ``python benchmarks/disturbed_videos/hidden_scene.py DAVIS
[--sequences A,B] [--only pillars graphics] [--json FILE]``.

Each sequence of DAVIS-2016 is segmented as `segment_video` does it by default: as it is, with pillars, letterboxed, and
with a logo and a clock, once with these left out and once with them as scene (``black_bars.fill`` and
``screen_graphics.fill``). The ground truth has no object in the bars, and does not know the graphics. `measure.py` has
the same disturbances, but the sequences of data sets are not searched for them.
"""

import argparse
import json
import tempfile
from pathlib import Path

from disturbances import DISTURBANCES
from layouts import Davis

import moseg

DAVIS = Davis()
HIDING = "none", "pillars", "letterbox", "graphics"


def measure(root: Path, sequence: str, hiding: str, fills: bool) -> dict[str, float]:
    """Return J and Fu of a sequence, in percent."""
    with tempfile.TemporaryDirectory() as folder:
        davis, masks = Path(folder, "davis"), Path(folder, "masks", sequence)
        DAVIS.write(davis, sequence, DISTURBANCES[hiding][1](DAVIS.read(root, sequence), None))
        settings = {"black_bars.fill": fills, "screen_graphics.fill": fills}
        result = moseg.segment_video(
            davis / DAVIS.frames / sequence, settings, store=Path(folder, "store"), progress=False
        )
        result.save(Path(folder, "out"))
        masks.parent.mkdir()
        Path(folder, "out", "masks").rename(masks)
        report = moseg.score(masks.parent, "davis16", root=davis, sequences=[sequence], progress=False)
    mean = report.rows[0].mean
    return {"J": mean.J, "F": mean.F}


def main() -> None:
    """Measure and print all that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=Path, metavar="DAVIS", help="folder of DAVIS-2016")
    parser.add_argument("--sequences", type=lambda names: names.split(","), help="names, separated by commas")
    parser.add_argument("--only", nargs="+", choices=HIDING, default=HIDING, help="what hides the scene")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    sequences = asked.sequences or DAVIS.sequences(asked.root)
    found = {}
    for hiding in asked.only:
        for fills in (True, False) if hiding != "none" else (True,):
            name = hiding if hiding == "none" else f"{hiding}, {'left out' if fills else 'as scene'}"
            scores = {sequence: measure(asked.root, sequence, hiding, fills) for sequence in sequences}
            mean = {key: sum(each[key] for each in scores.values()) / len(scores) for key in ("J", "F")}
            found[name] = {**scores, "mean": mean}
            figures = "  ".join(f"{sequence} {each['J']:.1f}" for sequence, each in found[name].items())
            print(f"{name}: J {figures}; Fu {mean['F']:.1f}", flush=True)
            if asked.json:
                asked.json.write_text(json.dumps({"videos": found}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
