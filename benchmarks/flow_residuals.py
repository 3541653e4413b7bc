"""Time and agreement of the k x k residuals of flow models: from moments, and by one pass for each pair of objects.

Run ``python benchmarks/flow_residuals.py [--objects K] [--repeat N] [--json FILE]``. Both ways start from the
same flow, depth and masks at 854 x 480 and alternate, so that their ratio is fair on a busy machine.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from moseg.schemas.parameters import FlowModelParams
from moseg.tasks.motion_models import FLOW_MODELS, FlowModel, fit_from_moments, flow_moments, residuals_from_moments
from moseg.tasks.motion_models.moments import depth_gauge
from moseg.tasks.motion_models.monomials import image_coordinates

HEIGHT, WIDTH = 480, 854
PARAMS = FlowModelParams()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--objects", type=int, default=20, help="objects with the background")
    parser.add_argument("--repeat", type=int, default=5, help="runs of each kind; their medians are shown")
    parser.add_argument("--json", type=Path, help="write ratios and differences here too")
    options = parser.parse_args()
    found = {}
    flow, inverse_depth, masks = frame_pair(options.objects)
    print(f"{'model':16} {'moments':>9} {'direct':>9} {'ratio':>7} {'largest relative difference':>28}")
    for name, model in FLOW_MODELS.items():
        times = {from_moments: [], direct: []}
        for _ in range(options.repeat):
            results = []
            for way in times:
                start = time.perf_counter()
                results.append(way(flow, inverse_depth, masks, options.objects, model))
                times[way].append(time.perf_counter() - start)
        fast, slow = (float(np.median(values)) for values in times.values())
        difference = np.nanmax(np.abs(results[0] - results[1]) / results[1])
        print(f"{name:16} {fast * 1e3:6.1f} ms {slow * 1e3:6.0f} ms {slow / fast:7.0f} {difference:28.1e}")
        found[name] = {"ratio": slow / fast, "difference": float(difference)}
    if options.json is not None:
        options.json.write_text(json.dumps(found), encoding="utf-8")


def frame_pair(num_objects: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the flow of boxes with own motions over a background, with 0.1 px of noise, and their depth and masks."""
    rng = np.random.default_rng(0)
    x, y = np.meshgrid(*image_coordinates(HEIGHT, WIDTH))
    inverse_depth = (0.2 + 0.1 * np.maximum(y, 0) + 0.02 * np.sin(9 * x) * np.cos(7 * y)).astype(np.float32)
    masks = np.zeros((HEIGHT, WIDTH), np.uint16)
    for k in range(1, num_objects):
        side = int(rng.integers(25, 120))
        top, left = rng.integers(0, HEIGHT - side), rng.integers(0, WIDTH - side)
        masks[top : top + side, left : left + side] = k
    theta = rng.normal(scale=2.0, size=(num_objects, 9))[masks]
    design = FLOW_MODELS["oc_depth"].design(x.ravel(), y.ravel(), inverse_depth.ravel().astype(np.float64))
    flow = np.einsum("ncp,np->nc", design, theta.reshape(-1, 9)).reshape(HEIGHT, WIDTH, 2)
    return (flow + rng.normal(scale=0.1, size=flow.shape)).astype(np.float32), inverse_depth, masks


def from_moments(flow, inverse_depth, masks, num_objects: int, model: FlowModel) -> np.ndarray:
    """Fit all objects and compute all residuals, reading each pixel once."""
    moments = flow_moments(flow, inverse_depth, masks, num_objects, model, PARAMS)
    return residuals_from_moments(moments, *fit_from_moments(moments, model, PARAMS))


def direct(flow, inverse_depth, masks, num_objects: int, model: FlowModel) -> np.ndarray:
    """Fit all objects by their design rows, then evaluate each model on each object's pixels."""
    shift, scale = depth_gauge(inverse_depth if model.uses_depth else None, model)
    x, y = np.meshgrid(*image_coordinates(HEIGHT, WIDTH))
    designs, flows = [], []
    for k in range(num_objects):
        own = masks == k
        designs.append(model.design(x[own], y[own], (inverse_depth[own].astype(np.float64) - shift) / scale))
        flows.append(flow[own].astype(np.float64))
    valid = [len(data) >= PARAMS.min_pixels for data in flows]
    residuals = np.full((num_objects, num_objects), np.nan)
    for i in np.flatnonzero(valid):
        rows = designs[i].reshape(-1, model.num_parameters)
        theta = np.linalg.lstsq(rows, flows[i].reshape(-1), rcond=PARAMS.rank_tolerance)[0]
        for j in np.flatnonzero(valid):
            residuals[i, j] = ((designs[j] @ theta - flows[j]) ** 2).sum(axis=1).mean()
    return residuals


if __name__ == "__main__":
    main()
