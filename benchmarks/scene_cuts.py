"""Cuts that are found where clips are joined, and in clips without any: ``python benchmarks/scene_cuts.py FOLDER ...``.

Each FOLDER has the frames of one clip without cuts. Searched with the default parameters are every clip, by all its
frames and by every second, third and fourth, and every two clips of one size, the last six frames of one before the
first six of the other, by all frames and by every second. The result is printed as JSON: joins, those found among them,
pairs of frames of clips, and those of them taken for cuts (``false``); then the joins that were missed.
"""

import itertools
import json
import sys
from pathlib import Path

import cv2
import numpy as np

from moseg.schemas.parameters import SceneCutParams
from moseg.tasks.scene_cuts import find_cuts

SUFFIXES = {".jpg", ".jpeg", ".png"}
AROUND = 6
"""Frames of each clip at a join."""
PARAMS = SceneCutParams()


def read_clip(folder: Path) -> list[np.ndarray]:
    """Return the frames of a clip, uint8 (y, x, 3), at twice the size at which cuts are searched.

    Raises FileNotFoundError if there are none.
    """
    frames = [cv2.imread(str(path)) for path in sorted(folder.iterdir()) if path.suffix.lower() in SUFFIXES]
    if not frames:
        raise FileNotFoundError(f"no frames in {folder}")
    factor = 2 * PARAMS.side / max(frames[0].shape[:2])
    return [cv2.resize(frame, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA) for frame in frames]


def main(folders: list[str]) -> None:
    cv2.setNumThreads(1)
    clips = {folder: read_clip(Path(folder)) for folder in folders}
    pairs, false = 0, 0
    for step, clip in itertools.product((1, 2, 3, 4), clips.values()):
        frames = clip[::step]
        pairs += len(frames) - 1
        false += len(find_cuts(frames, PARAMS))
    joins, missed = 0, []
    for step, (before, after) in itertools.product((1, 2), itertools.permutations(clips, 2)):
        first, second = clips[before][::step][-AROUND:], clips[after][::step][:AROUND]
        if first[0].shape == second[0].shape:
            joins += 1
            if len(first) not in find_cuts(first + second, PARAMS):
                missed.append((before, after, step))
    print(
        json.dumps({"clips": len(clips), "joins": joins, "found": joins - len(missed), "pairs": pairs, "false": false})
    )
    for each in missed:
        print(*each, file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
