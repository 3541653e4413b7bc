"""Cuts that are found where clips are joined, and in clips without any: ``python benchmarks/scene_cuts.py FOLDER ...``.

Each FOLDER has the frames of one clip without cuts. Searched with the default parameters are every clip, by all its
frames and by every second, third and fourth; every two clips of one size, the last six frames of one before the first
six of the other, by all frames and by every second; every clip joined to black frames and to title cards, which follow
it or come before it; every two clips in a row that fade through black; and every clip disturbed in several ways. The
result is printed as JSON: joins, those found among them, pairs of frames of clips, and those of them taken for cuts
(``false``); then the joins that were missed.
"""

import itertools
import json
import sys
from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np
from disturbed_videos.disturbances import DISTURBANCES, Video, darken

from moseg.schemas.parameters import SceneCutParams
from moseg.tasks.scene_cuts import find_cuts

SUFFIXES = {".jpg", ".jpeg", ".png"}
AROUND = 6
"""Frames of each clip at a join."""
FADE = 10
"""Frames over which a clip fades."""
PARAMS = SceneCutParams()
DISTURBED = ("shaken", "grey", "noisy", "compressed", "dark", "flash", "exposure")
"""Disturbances that need no ground truth."""


def read_clip(folder: Path) -> list[np.ndarray]:
    """Return the frames of a clip, uint8 (y, x, 3), at twice the size at which cuts are searched.

    Raises FileNotFoundError if there are none.
    """
    frames = [cv2.imread(str(path)) for path in sorted(folder.iterdir()) if path.suffix.lower() in SUFFIXES]
    if not frames:
        raise FileNotFoundError(f"no frames in {folder}")
    factor = 2 * PARAMS.side / max(frames[0].shape[:2])
    return [cv2.resize(frame, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA) for frame in frames]


def disturb(name: str, frames: list[np.ndarray], rng: np.random.Generator) -> list[np.ndarray]:
    """Return the frames of a clip disturbed in the way of this name."""
    nothing = [np.zeros(frame.shape[:2], np.uint8) for frame in frames]
    return DISTURBANCES[name][1](Video(frames, nothing), rng).frames


def make_cards(shape: tuple[int, ...]) -> list[list[np.ndarray]]:
    """Return frames uint8 `shape` without a scene: black, and a bright and a dark title, with faint noise."""
    rng, cards = np.random.default_rng(0), []
    for ground, ink in ((0, 0), (250, 30), (20, 240)):
        card = np.full(shape, ground, np.uint8)
        cv2.putText(card, "THE END", (shape[1] // 5, shape[0] // 2), cv2.FONT_HERSHEY_SIMPLEX, 1, [ink] * 3, 2)
        noisy = (card + rng.normal(0, 1, shape) for _ in range(AROUND))
        cards.append([np.clip(each, 0, 255).astype(np.uint8) for each in noisy])
    return cards


def count_cards(clips: Iterable[list[np.ndarray]]) -> dict[str, int]:
    """Return the number of joins of clips with frames without a scene, and of those that are found."""
    joins = found = 0
    for frames in clips:
        for card in make_cards(frames[0].shape):
            for first, second in ((frames[-AROUND:], card), (card, frames[:AROUND])):
                joins += 1
                found += len(first) in find_cuts(first + second, PARAMS)
    return {"joins": joins, "found": found}


def fade(frames: list[np.ndarray]) -> list[np.ndarray]:
    """Return frames that fade to black."""
    return [darken(frame, share) for frame, share in zip(frames, np.linspace(1, 0, len(frames)), strict=True)]


def count_fades(clips: Iterable[list[np.ndarray]]) -> dict[str, int]:
    """Return the number of pairs of clips that fade through black, and of those between which a cut is found."""
    joins = found = 0
    for before, after in itertools.pairwise(clips):
        if before[0].shape == after[0].shape:
            first, second = (
                [*before[-AROUND:], *fade(before[::-1][:FADE])],
                [*fade(after[:FADE])[::-1], *after[:AROUND]],
            )
            cuts = find_cuts(first + second, PARAMS)
            joins += 1
            found += any(abs(cut - len(first)) <= 2 for cut in cuts)
    return {"joins": joins, "found": found}


def count_false(clips: Iterable[list[np.ndarray]]) -> dict[str, int]:
    """Return the number of pairs of frames of clips without cuts, and of those that are taken for cuts."""
    pairs = false = 0
    for frames in clips:
        pairs += len(frames) - 1
        false += len(find_cuts(frames, PARAMS))
    return {"pairs": pairs, "false": false}


def main(folders: list[str]) -> None:
    cv2.setNumThreads(1)
    clips = {folder: read_clip(Path(folder)) for folder in folders}
    thinned = count_false(clip[::step] for step, clip in itertools.product((1, 2, 3, 4), clips.values()))
    rng = np.random.default_rng(0)
    disturbed = count_false(disturb(name, clip, rng) for name, clip in itertools.product(DISTURBED, clips.values()))
    joins, missed = 0, []
    for step, (before, after) in itertools.product((1, 2), itertools.permutations(clips, 2)):
        first, second = clips[before][::step][-AROUND:], clips[after][::step][:AROUND]
        if first[0].shape == second[0].shape:
            joins += 1
            if len(first) not in find_cuts(first + second, PARAMS):
                missed.append((before, after, step))
    found = {"clips": len(clips), "joins": joins, "found": joins - len(missed), **thinned}
    beside = {"cards": count_cards(clips.values()), "fades": count_fades(clips.values()), "disturbed": disturbed}
    print(json.dumps({**found, **beside}))
    for each in missed:
        print(*each, file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
