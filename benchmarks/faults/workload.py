"""The workload that faults disturb: a video of a second, the commands on it, and their undisturbed results."""

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

MOSEG = (sys.executable, "-c", "from moseg.workflows.cli import main; main()")
HEIGHT, WIDTH = 96, 128
SECTIONS = ("--section-length", "4", "--set", "sections.overlap=2")
_COUNTS = re.compile(r"(\d+) artifacts computed, (\d+) reused")


class Workload(NamedTuple):
    """A video with ground truth, and the effort of the commands on it.

    Attributes
    ----------
    root : Path
        Root of a data set of kind ``folder`` with one sequence.
    num_samples : int
        Samples of each robust fit: they determine how long a run takes.
    """

    root: Path
    num_samples: int

    def command(self, name: str, store: str, out: Path, *options: str) -> list[str]:
        """Return the command line of `eval` (its report at `out`) or of `segment` (its masks under `out`)."""
        if name == "eval":
            work = ["eval", "--dataset", "folder", "--root", str(self.root), "--json", str(out)]
        else:
            work = ["segment", str(self.root / "squares" / "frames"), "--out", str(out), "--keep-cues"]
        samples = f"fundamental.num_samples={self.num_samples}"
        return [*MOSEG, *work, f"--store={store}", "--quiet", *SECTIONS, "--set", samples, *options]


def write_workload(root: Path, num_frames: int = 16, num_samples: int = 2000) -> Workload:
    """Write frames and masks of two textured squares with different motions over a panning background."""
    rng = np.random.default_rng(0)

    def texture(height: int, width: int, brightness: int) -> np.ndarray:
        noise = rng.integers(0, 256, (height, width, 3)).astype(np.uint8)
        return cv2.GaussianBlur(noise, (0, 0), 1.2) // 2 + np.uint8(brightness)

    backdrop = texture(HEIGHT, WIDTH + num_frames, 60)
    squares = texture(26, 26, 100), texture(22, 30, 120)
    for number in range(num_frames):
        image = backdrop[:, number : number + WIDTH].copy()
        labels = np.zeros((HEIGHT, WIDTH), np.uint8)
        corners = (12, 14 + 3 * number), (28 + 2 * number, 84 - number)
        for label, ((y, x), square) in enumerate(zip(corners, squares, strict=True), start=1):
            height, width = square.shape[:2]
            image[y : y + height, x : x + width] = square
            labels[y : y + height, x : x + width] = label
        for folder, picture in (("frames", image), ("masks", labels)):
            path = root / "squares" / folder / f"{number:05d}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(cv2.imencode(".png", picture)[1].tobytes())
    return Workload(root, num_samples)


def read_counts(output: str) -> tuple[int, int]:
    """Return the artifacts computed and reused, as the last line of a command gives them."""
    found = _COUNTS.findall(output)
    if not found:
        raise ValueError(f"no counts of artifacts in {output!r}")
    return int(found[-1][0]), int(found[-1][1])


def read_files(folder: Path, kinds: Sequence[str] = ("*",)) -> dict[str, bytes]:
    """Return the content of every file under a folder, by relative path; nothing if there is no folder."""
    paths = {path for kind in kinds for path in folder.rglob(kind) if path.is_file()}
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(paths)}
