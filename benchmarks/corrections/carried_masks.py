"""Masks of one frame carried along the flow, and objects grown from a click, against the annotation.

Run ``python benchmarks/corrections/carried_masks.py DAVIS [--out FILE]`` with the folder of DAVIS, which has
``JPEGImages/480p`` and ``Annotations/480p``. The annotation of frame 20 of each sequence, all its objects as one, is
carried to the frames before and after it; and an object is grown from points in it: its innermost point, and four at
random that are not close to its outline. Printed, and written as JSON, is the IoU with the annotation.
"""

import argparse
import json
import sys
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from moseg.schemas.configs import PipelineConfig
from moseg.tasks.corrections.carrying import Carrier, carry_mask, outline_mask, start_carrying
from moseg.tasks.corrections.growing import Grower, grow_object
from moseg.tasks.flow.dis import estimate_flow
from moseg.tasks.frame_grid import flow_on_grid, grid_shape, reduced_shape
from moseg.tasks.half_floats import to_float32
from moseg.tasks.saliency import choose_background, estimate_saliency

FRAME, DISTANCES, NUM_CLICKS = 20, (1, 3, 6, 10, 15, 20), 5
CONFIG = PipelineConfig()
HOW = "benchmarks/corrections/carried_masks.py DAVIS"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("davis", type=Path)
    parser.add_argument("--out", type=Path, default=None, help="JSON file of the figures")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    rng, rows = np.random.default_rng(0), {}
    for folder in sorted((options.davis / "JPEGImages" / "480p").iterdir()):
        images, truth = _read(folder)
        flows = [[estimate_flow(*pair, CONFIG.flow) for pair in _pairs(images, step)] for step in (1, -1)]
        carried = _carry(images, truth[FRAME], *flows)
        at = {d: [FRAME + s * d for s in (-1, 1) if FRAME + s * d in carried] for d in DISTANCES}
        rows[folder.name] = {
            "carried": {d: round(float(np.mean([_iou(carried[t], truth[t]) for t in at[d]])), 3) for d in DISTANCES},
            "click": round(float(np.mean(_click(images, truth[FRAME], *flows, rng))), 3),
        }
        print(folder.name, rows[folder.name], flush=True)
    mean = {d: round(float(np.mean([row["carried"][d] for row in rows.values()])), 2) for d in DISTANCES}
    click = round(float(np.mean([row["click"] for row in rows.values()])), 2)
    print("mean", {"carried": mean, "click": click})
    if options.out is not None:
        found = {"frame": FRAME, "mean": {"carried": mean, "click": click}, "sequences": rows}
        about = {"name": options.out.stem, "provenance": "measured apart", "how": HOW}
        options.out.write_text(json.dumps({**about, "result": found}, indent=1) + "\n")
    return 0


def _read(folder: Path) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return images and annotated masks of the frames that are reached."""
    paths = sorted(folder.glob("*.jpg"))[: FRAME + max(DISTANCES) + 1]
    annotations = Path(str(folder).replace("JPEGImages", "Annotations"))
    images = [np.asarray(Image.open(path).convert("RGB")) for path in paths]
    masks = [np.asarray(Image.open(annotations / f"{path.stem}.png")) for path in paths]
    return images, [mask.reshape(*mask.shape[:2], -1)[..., 0] > 0 for mask in masks]


def _pairs(images: list[np.ndarray], step: int) -> list[tuple[np.ndarray, np.ndarray]]:
    return [pair[::step] for pair in pairwise(images)]


def _carry(images, mask, forward, backward) -> dict[int, np.ndarray]:
    """Return the mask in all other frames."""
    params, size = Carrier(CONFIG.carrying, CONFIG.appearance, CONFIG.refinement), mask.shape
    grid = reduced_shape(size, CONFIG.carrying.side)
    start, masks = start_carrying(images[FRAME], mask, grid, params), {}
    for step, stop in ((1, len(images)), (-1, -1)):
        carried = start
        for t in range(FRAME + step, stop, step):
            back, forth = (backward[t - 1], forward[t - 1]) if step == 1 else (forward[t], backward[t])
            flows = (flow_on_grid(flow, grid, size) for flow in (back, forth))
            carried = carry_mask(carried, images[t], *flows, params)
            masks[t] = outline_mask(carried, images[t], params.refinement)
    return masks


def _click(images, mask, forward, backward, rng) -> list[float]:
    """Return the IoU of what grows from each of some points in a mask."""
    saliency = CONFIG.saliency
    pairs = forward[: -1 : saliency.selection_step]
    reduced = [flow_on_grid(flow, grid_shape(mask.shape, saliency.working_side)) for flow in pairs]
    t, background = FRAME, choose_background(reduced, saliency)
    neighbours = images[t - 1], images[t + 1], backward[t - 1], forward[t]
    seen = estimate_saliency(images[t], *neighbours, saliency, background)
    depth = cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    inner = np.argwhere(depth > 0.3 * depth.max())
    points = [np.unravel_index(depth.argmax(), depth.shape), *rng.permutation(inner)[: NUM_CLICKS - 1]]
    params, none = Grower(CONFIG.growing, CONFIG.appearance, CONFIG.refinement), np.zeros((0, 2))
    evidence = to_float32(seen.saliency), to_float32(seen.residual_flows)
    return [_iou(grow_object(images[t], *evidence, np.array([[x, y]], float), none, params), mask) for y, x in points]


def _iou(mask0: np.ndarray, mask1: np.ndarray) -> float:
    union = (mask0 | mask1).sum()
    return float((mask0 & mask1).sum() / union) if union else 1.0


if __name__ == "__main__":
    sys.exit(main())
