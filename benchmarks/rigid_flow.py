"""Residual of each flow model on the flow of random rigid motions, as a share of the RMS flow.

Run ``python benchmarks/rigid_flow.py [--motions N] [--json FILE]``. Each motion is a random camera before a random
scene: a field of view of 30 to 100 degrees, a slanted plane with waves and boxes as inverse depth, a translation and a
rotation in random directions, and a random share of the rotation in the flow. The flow is that of Longuet-Higgins and
Prazdny in units of half the longer side, without noise; models are fitted to it by least squares in float64. In
``zoomed`` the focal length changes too, and the inverse depth that the model is given is scaled and shifted; in
``stored`` flow and inverse depth are rounded to float32; in ``off-centre`` the principal point lies 5 % of the longer
side from the image's centre, in a random direction, and the model assumes the centre.
"""

import argparse
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

from moseg.tasks.motion_models import FLOW_MODELS, FlowModel
from moseg.tasks.motion_models.monomials import image_coordinates

HEIGHT, WIDTH, STEP = 480, 854, 24
OFF_CENTRE = 0.05
CASES = {"rigid": tuple(FLOW_MODELS), **dict.fromkeys(("zoomed", "stored", "off-centre"), ("oc_depth",))}
"""Measurements, with their models."""
STATISTICS = ("median", "p95", "max")


class View(NamedTuple):
    """Flow (N, 2) of a rigid motion in units of half the longer side, and the relative inverse depth (N) given."""

    flow: np.ndarray
    inverse_depth: np.ndarray


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motions", type=int, default=1000, help="random motions")
    parser.add_argument("--json", type=Path, help="write the shares here too")
    options = parser.parse_args()
    x, y = (grid.ravel() for grid in np.meshgrid(*(axis[::STEP] for axis in image_coordinates(HEIGHT, WIDTH))))
    shares: dict[str, dict[str, list[float]]] = {case: {name: [] for name in models} for case, models in CASES.items()}
    for seed in range(options.motions):
        for case, models in CASES.items():
            view = rigid_view(x, y, case, np.random.default_rng(seed))
            for name in models:
                shares[case][name].append(share_left(x, y, view, FLOW_MODELS[name]))
    found = {
        case: {name: summary(np.array(values)) for name, values in by_model.items()}
        for case, by_model in shares.items()
    }
    print(f"{'share of RMS flow left, percent':32}" + "".join(f"{name:>10}" for name in STATISTICS))
    for case, by_model in found.items():
        for name, values in by_model.items():
            print(f"{case:12} {name:19}" + "".join(f"{values[each]:10.2g}" for each in STATISTICS))
    if options.json is not None:
        options.json.write_text(json.dumps({"num_motions": options.motions, **found}), encoding="utf-8")


def rigid_view(x: np.ndarray, y: np.ndarray, case: str, rng: np.random.Generator) -> View:
    """Return the flow at image coordinates x, y (N) of one random motion, and the given inverse depth there."""
    focal = 1 / np.tan(np.radians(rng.uniform(30, 100)) / 2)
    rho = random_inverse_depth(x, y, rng)
    translation, rotation = rng.normal(size=(2, 3))
    share = rng.uniform()
    zoom, scale, shift = rng.uniform(-0.05, 0.05), rng.uniform(0.2, 5), rng.uniform(-0.5, 2)
    angle = rng.uniform(0, 2 * np.pi)
    if case == "off-centre":
        # Half the longer side is the unit.
        x, y = x - 2 * OFF_CENTRE * np.cos(angle), y - 2 * OFF_CENTRE * np.sin(angle)
    X, Y = x / focal, y / focal
    tx, ty, tz = translation
    wx, wy, wz = rotation
    translated = np.stack([(-tx + X * tz) * rho, (-ty + Y * tz) * rho], axis=1)
    turned = np.stack([wx * X * Y - wy * (1 + X**2) + wz * Y, wx * (1 + Y**2) - wy * X * Y - wz * X], axis=1)
    flow = (1 - share) * translated / rms(translated) + share * turned / rms(turned)
    if case == "zoomed":
        return View(flow + zoom * np.stack([x, y], axis=1), scale * rho + shift)
    if case == "stored":
        return View(flow.astype(np.float32).astype(np.float64), rho.astype(np.float32).astype(np.float64))
    return View(flow, rho)


def random_inverse_depth(x: np.ndarray, y: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the relative, positive inverse depth of a slanted plane with waves, and boxes nearer than it."""
    slope, wave, phase = rng.uniform(-0.3, 0.3, 2), rng.uniform(2, 8, 2), rng.uniform(0, 2 * np.pi, 2)
    rho = 0.7 + slope[0] * x + slope[1] * y + 0.1 * np.sin(wave[0] * x + phase[0]) * np.cos(wave[1] * y + phase[1])
    for _ in range(rng.integers(1, 5)):
        left, top = rng.uniform(-1, 0.7), rng.uniform(-0.56, 0.3)
        width, height = rng.uniform(0.1, 0.6, 2)
        inside = (x >= left) & (x < left + width) & (y >= top) & (y < top + height)
        rho[inside] += rng.uniform(0.1, 1)
    return rho


def share_left(x: np.ndarray, y: np.ndarray, view: View, model: FlowModel) -> float:
    """Return the RMS of the flow that the fitted model does not explain, over the RMS of the flow."""
    design = model.design(x, y, view.inverse_depth)
    basis = np.linalg.qr(design.reshape(-1, model.num_parameters)).Q
    flow = view.flow.ravel()
    # Projected twice, because the basis is not exactly orthogonal.
    left = flow - basis @ (basis.T @ flow)
    left -= basis @ (basis.T @ left)
    return rms(left.reshape(-1, 2)) / rms(view.flow)


def rms(flow: np.ndarray) -> float:
    """Return the root mean square length."""
    return float(np.sqrt((flow**2).sum(axis=1).mean()))


def summary(shares: np.ndarray) -> dict[str, float]:
    """Return median, 95th percentile and maximum, percent."""
    median, p95 = np.quantile(shares, (0.5, 0.95))
    return dict(zip(STATISTICS, (100 * float(value) for value in (median, p95, shares.max())), strict=True))


if __name__ == "__main__":
    main()
