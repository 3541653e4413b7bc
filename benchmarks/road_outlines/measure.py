"""Masks of road scenes against outlines drawn by hand: ``python benchmarks/road_outlines/measure.py --root ROOT
[--workers N] [--json FILE]``.

KT3DMoSeg has labelled points and no masks. Its points are sparse on static things beside movers, and many of a mover's
lie on its very outline, so that a mask that is too large scores better than the true one. Here one mover in each of ten
clips was outlined by hand, to 2 or 3 px, in the clip's middle frame (``outlines.json``). Each part of what draws masks
is left out in turn.
"""

import argparse
import json
import tempfile
from pathlib import Path

import cv2
import numpy as np
import scipy.io

import moseg

OUTLINES = json.loads(Path(__file__).with_name("outlines.json").read_text(encoding="utf-8"))
PARTS = {
    "all": {},
    "plain-points": {"object_points.min_contrast": 0.0},
    "wide": {"track_masks.closing": 0.0},
    "no-colours": {"local_colours.share": 0.0},
    "none": {"object_points.min_contrast": 0.0, "track_masks.closing": 0.0, "local_colours.share": 0.0},
}
"""Parameters without one of the parts, and without all of them."""
SURROUNDINGS = 50
"""Distance from an outline up to which masks are compared, px: other movers are farther away, or counted as false."""
NEAR = 10
"""Distance from an outline up to which labelled points of movers are taken for those of the outlined one, px."""
BEYOND = (0, 1, 2, 3)
"""Distances from an outline by which points may lie outside, px."""


def main() -> None:
    """Measure and print the scores of all clips without each part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, required=True, help="folder of KT3DMoSeg, with the frames of its clips")
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    found = {"masks": {}, "points": _points_inside(asked.root)}
    with tempfile.TemporaryDirectory() as store:
        for part, changes in PARTS.items():
            scores = {clip: _scores(asked.root, clip, changes, store, asked.workers) for clip in OUTLINES}
            mean = {name: float(np.mean([each[name] for each in scores.values()])) for name in ("J", "P", "R")}
            found["masks"][part] = {**scores, "mean": mean}
            print(f"{part}: " + "  ".join(f"{name} {value:.1f}" for name, value in mean.items()), flush=True)
    inside = "  ".join(f"{distance} px {share:.1f} %" for distance, share in found["points"].items())
    print(f"labelled points of the outlined movers, by how far they may lie outside: {inside}")
    if asked.json is not None:
        asked.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def _scores(root: Path, clip: str, changes: dict, store: str, workers: int) -> dict[str, float]:
    """Return J, precision and recall of a clip's mask around its outline, percent."""
    result = moseg.segment_video(root / clip / "images", changes, store=store, workers=workers, progress=False)
    moving = result.labels[OUTLINES[clip]["frame"]] > 0
    truth, distance = _outlined(clip, moving.shape)
    moving &= distance <= SURROUNDINGS
    both = np.count_nonzero(moving & truth)
    sizes = {"J": moving | truth, "P": moving, "R": truth}
    return {name: 100 * both / max(np.count_nonzero(size), 1) for name, size in sizes.items()}


def _outlined(clip: str, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the pixels of a clip's outlined mover, bool (y, x), and the distance of each pixel from it, px."""
    truth = np.zeros(shape, np.uint8)
    cv2.fillPoly(truth, [np.rint(OUTLINES[clip]["outline"]).astype(np.int32)], 1)
    return truth > 0, cv2.distanceTransform(1 - truth, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)


def _points_inside(root: Path) -> dict[str, float]:
    """Return how many labelled points of outlined movers are no farther outside, percent, as the mean of the clips."""
    shares = []
    for clip, drawn in OUTLINES.items():
        data = scipy.io.loadmat(root / f"{clip}_Tracks.mat", simplify_cells=True)["Data"]
        frame = cv2.imread(str(sorted((root / clip / "images").iterdir())[drawn["frame"]]))
        moves = (data["visibleSparse"][:, drawn["frame"]] > 0) & (data["GtLabel"] > 1)
        x, y = np.rint(data["ySparse"][:2, moves, drawn["frame"]]).astype(int) - 1
        inside = (x >= 0) & (y >= 0) & (x < frame.shape[1]) & (y < frame.shape[0])
        distance = _outlined(clip, frame.shape[:2])[1][y[inside], x[inside]]
        shares.append([np.mean(distance[distance <= NEAR] <= beyond) for beyond in BEYOND])
    return dict(zip(map(str, BEYOND), (100 * np.mean(shares, axis=0)).tolist(), strict=True))


if __name__ == "__main__":
    main()
