"""Scores on disturbed videos: ``python benchmarks/disturbed_videos/measure.py DAVIS [--sequences A,B] [--workers N]
[--disturbances NAME ...] [--config FILE] [--json FILE]``.

Each sequence of DAVIS-2016 is changed in several ways, with its ground truth, and segmented.
What differs between a sequence and its mirror image is chance; what is lost beyond that tells what the method relies
on.
"""

import argparse
import json
import tempfile
import zlib
from pathlib import Path

import cv2
import numpy as np
from disturbances import DISTURBANCES, Video

import moseg

FRAMES, TRUTHS = Path("JPEGImages", "480p"), Path("Annotations", "480p")


def read_video(root: Path, sequence: str) -> Video:
    """Return a sequence of DAVIS; raises FileNotFoundError if it is not there."""
    frames = sorted((root / FRAMES / sequence).glob("*.jpg"))
    if not frames:
        raise FileNotFoundError(f"no frames in {root / FRAMES / sequence}")
    truths = [root / TRUTHS / sequence / f"{path.stem}.png" for path in frames]
    return Video(
        [cv2.imread(str(path)) for path in frames], [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in truths]
    )


def write_video(root: Path, sequence: str, video: Video) -> None:
    """Write a sequence in the layout of DAVIS."""
    quality = [cv2.IMWRITE_JPEG_QUALITY, 95]
    for folder, images, suffix, options in ((FRAMES, video.frames, "jpg", quality), (TRUTHS, video.truths, "png", [])):
        (root / folder / sequence).mkdir(parents=True)
        for number, image in enumerate(images):
            cv2.imwrite(str(root / folder / sequence / f"{number:05}.{suffix}"), image, options)


def measure(
    root: Path, sequences: list[str], name: str, workers: int, config: Path | None
) -> dict[str, dict[str, float]]:
    """Return J and Fu of each disturbed sequence, and their means, in percent."""
    with tempfile.TemporaryDirectory() as folder:
        disturbed = Path(folder, "davis")
        for sequence in sequences:
            rng = np.random.default_rng(zlib.crc32(sequence.encode()))
            write_video(disturbed, sequence, DISTURBANCES[name][1](read_video(root, sequence), rng))
        store = Path(folder, "store")
        report = moseg.evaluate(
            "davis16",
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
    parser.add_argument("root", type=Path, metavar="DAVIS", help="folder of DAVIS-2016")
    parser.add_argument("--sequences", type=lambda names: names.split(","), help="names, separated by commas")
    parser.add_argument("--disturbances", nargs="+", choices=DISTURBANCES, default=list(DISTURBANCES))
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--config", type=Path, help="parameters, as of moseg eval")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    sequences = asked.sequences or sorted(path.name for path in (asked.root / FRAMES).iterdir())
    found = {}
    for name in asked.disturbances:
        found[name] = measure(asked.root, sequences, name, asked.workers, asked.config)
        figures = "  ".join(f"{sequence} {each['J']:.1f}" for sequence, each in found[name].items())
        print(f"{DISTURBANCES[name][0]}: J {figures}; Fu {found[name]['mean']['F']:.1f}", flush=True)
        if asked.json:
            asked.json.write_text(json.dumps({"videos": found}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
