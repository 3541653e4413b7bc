"""Affinities between objects on KT3DMoSeg, with objects of one motion each and the number of motions given.

``python benchmarks/kt3dmoseg/object_affinities.py [ROOT] [--seeds N] [--grouping linkage|spectral] [--stress]`` prints
for each affinity the objects and the trajectories in a wrong group (percent, mean over clips and seeds) and how many
cases have no error, for the three partitions of ``object_partitions.py``; then the objects in a wrong group of
generated scenes, in some of which the movers are one object each. ``--stress`` adds noise, few tracks and impure
objects.
"""

import argparse
import os
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from object_partitions import PARTITIONS, Case, cases, read_clips
from scipy.cluster.hierarchy import cut_tree, linkage
from scipy.spatial.distance import squareform

from moseg.schemas.parameters import AffinityParams, FundamentalParams
from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.schemas.presets import GEOMETRIES
from moseg.tasks.affinity import estimate_affinity, hypothesis_affinity
from moseg.tasks.clustering.fusion import best_chain, unit_diagonal
from moseg.tasks.clustering.kmeans import cluster_points
from moseg.tasks.clustering.spectral import embed_views
from moseg.tasks.geometry import fit_fundamentals, fundamental_residuals
from moseg.tasks.metrics.clustering_error import clustering_error
from moseg.tasks.synthetic.rigid_tracks import rigid_tracks

IMAGE_SHAPE = (375, 1242)
WHOLE_FRAME = 10**6
"""Object id above all others, for samples of the whole frame."""
NUM_SCENES = 10
SCENES = {
    "[6, 1, 1] exact": ([6, 1, 1], 0.0),
    "[6, 1, 1] 0.1 px": ([6, 1, 1], 0.1),
    "[4, 2, 2] exact": ([4, 2, 2], 0.0),
}
"""Numbers of objects of the background and of each moving object, and noise, px."""

Affinity = Callable[[Case, np.random.Generator], np.ndarray]


def from_hypotheses(case: Case, rng: np.random.Generator, params: HypothesisAffinityParams) -> np.ndarray:
    """Return the affinity from hypotheses of the frame."""
    return hypothesis_affinity(case.points, case.visible, case.owner, case.num_objects, params, rng)


def from_models(
    case: Case, rng: np.random.Generator, fundamental: FundamentalParams, params: AffinityParams
) -> np.ndarray:
    """Return the affinity from residuals of the objects under one another's fundamental matrices."""
    return unit_diagonal(estimate_affinity(model_residuals(case, fundamental), params))


@cache
def model_residuals(case: Case, params: FundamentalParams) -> np.ndarray:
    """Return the residuals (M, K, K) from which several affinities start."""
    rng = np.random.default_rng(0)
    residuals = []
    for frame in range(case.points.shape[1] - params.gap):
        frames = [frame, frame + params.gap]
        seen = (case.owner >= 0) & case.visible[:, frames].all(axis=1)
        tracks = *case.points[seen][:, frames].swapaxes(0, 1), case.owner[seen].astype(np.uint16)
        fits = fit_fundamentals(*tracks, case.num_objects, params, rng, IMAGE_SHAPE)
        residuals.append(fundamental_residuals(fits, *tracks, params))
    return np.stack(residuals)


def affinities() -> dict[str, Affinity | None]:
    """Return the affinities of the table's rows; None is an affinity without information."""
    paper, ours = FundamentalParams(**GEOMETRIES["paper"]["fundamental"]), FundamentalParams()
    rows: dict[str, Affinity | None] = {"everything one motion": None}
    for reading in ("objects", "models"):
        for t in (1, 2, 3):
            ork = AffinityParams(method="ork", ork_reading=reading, ork_threshold=t)
            rows[f"paper's ORK, ranks {reading}, t = {t}"] = partial(from_models, fundamental=paper, params=ork)
    for direction in ("mean", "min"):
        # No object is marked as the background here.
        size = AffinityParams(method="residual", direction=direction)
        rows[f"residual size, {direction} of directions"] = partial(from_models, fundamental=ours, params=size)
    whole = {"num_objects": WHOLE_FRAME}
    hypotheses = {
        "whole frame, 5 %, cubed, H + F": {**whole, "window": 0.05, "fade": 0.0, "power": 3.0, "fusion": "sum"},
        "whole frame": whole,
        "ranks alone": {"fade": 0.0},
        "homography alone": {"models": ("homography",)},
        "fundamental alone": {"models": ("fundamental",)},
        "100 of each model": {"num_hypotheses": 100},
        "default": {},
    }
    for name, values in hypotheses.items():
        rows[f"hypotheses: {name}"] = partial(from_hypotheses, params=HypothesisAffinityParams(**values))
    return rows


def group(affinity: np.ndarray, num_motions: int, grouping: str) -> np.ndarray:
    """Return the motion of each object; unobserved affinities are filled in from the best chain over other objects."""
    known = np.where(np.isfinite(affinity), affinity, best_chain(np.nan_to_num(affinity)))
    if grouping == "spectral":
        return cluster_points(embed_views(known[None], num_motions).coordinates, num_motions)
    distance = np.maximum(1.0 - (known + known.T) / 2, 0.0)
    np.fill_diagonal(distance, 0.0)
    # A cut at a height would leave too few groups where heights are equal.
    return cut_tree(linkage(squareform(distance, checks=False), "average"), n_clusters=num_motions)[:, 0]


def errors(found: list[Case], affinity: Affinity | None, grouping: str) -> np.ndarray:
    """Return objects and trajectories in a wrong group, percent: (cases, 2)."""
    rows = []
    for number, case in enumerate(found):
        labels = np.zeros(case.num_objects, np.int64)
        if affinity is not None:
            labels = group(affinity(case, np.random.default_rng(number)), case.num_motions, grouping)
        by_track = clustering_error(labels[case.owner], case.motion[case.owner])
        rows.append((clustering_error(labels, case.motion), by_track))
    return np.array(rows)


def noisy(case: Case, rng: np.random.Generator, scale: float) -> Case:
    """Return trajectories with noise of this standard deviation in each coordinate, px."""
    return replace(case, points=case.points + rng.normal(0, scale, case.points.shape))


def few(case: Case, rng: np.random.Generator, most: int) -> Case:
    """Return at most so many trajectories of each object."""
    kept = np.concatenate([rng.permutation(np.flatnonzero(case.owner == k))[:most] for k in range(case.num_objects)])
    return replace(case, points=case.points[kept], visible=case.visible[kept], owner=case.owner[kept])


def polluted(case: Case, rng: np.random.Generator, share: float) -> Case:
    """Assign trajectories of the background to each moving object, up to a share of its trajectories."""
    owner = case.owner.copy()
    for mover in np.flatnonzero(case.motion):
        background = np.flatnonzero(case.motion[owner] == 0)
        caught = round(share / (1 - share) * np.count_nonzero(case.owner == mover))
        # At most a tenth of the rest, because some clips have less background than moving objects.
        owner[rng.choice(background, min(caught, len(background) // 10), replace=False)] = mover
    return replace(case, owner=owner)


STRESS = {
    "+0.5 px": partial(noisy, scale=0.5),
    "+1 px": partial(noisy, scale=1.0),
    "12 tracks": partial(few, most=12),
    "20 % caught": partial(polluted, share=0.2),
}


def generated(num_objects: list[int], noise: float) -> list[Case]:
    """Return scenes of generated tracks, 10 frames and 25 tracks per object."""
    generators = (np.random.default_rng(seed) for seed in range(NUM_SCENES))
    return [Case(*rigid_tracks(num_objects, 10, 25, noise, rng)) for rng in generators]


def stressed(found: list[Case], change: Callable[[Case, np.random.Generator], Case]) -> list[Case]:
    return [change(case, np.random.default_rng(number)) for number, case in enumerate(found)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(os.environ.get("MOSEG_DATA", "."), "kt3dmoseg")
    parser.add_argument("root", type=Path, nargs="?", default=default, help="folder of <clip>_Tracks.mat")
    parser.add_argument("--seeds", type=int, default=3, help="runs; each cuts, orders and draws anew")
    parser.add_argument("--grouping", choices=("linkage", "spectral"), default="linkage")
    parser.add_argument("--rows", default="", help="only affinities whose name contains this")
    parser.add_argument("--stress", action="store_true", help="also noise, few tracks and impure objects")
    options = parser.parse_args()
    rows = {name: row for name, row in affinities().items() if options.rows in name}
    clips = read_clips(options.root)
    real = {p: [cases(clips, p, seed) for seed in range(options.seeds)] for p in PARTITIONS}
    print(f"{len(clips)} clips, {options.seeds} seeds, {options.grouping}: objects/trajectories wrong, % (no error)")
    print_head([*PARTITIONS, "all", "spread"])
    for name, row in rows.items():
        found = {p: [errors(run, row, options.grouping) for run in runs] for p, runs in real.items()}
        everything = np.array(list(found.values()))  # [partition, seed, clip, 2]
        spread = everything[..., 1].mean(axis=(0, 2)).std(ddof=1) if options.seeds > 1 else 0.0
        cells = [cell(np.concatenate(runs)) for runs in found.values()]
        print_row(name, [*cells, cell(everything.reshape(-1, 2)), f"{spread:.2f}"])
    others = {name: generated(*kind) for name, kind in SCENES.items()}
    if options.stress:
        flat = [case for runs in real.values() for run in runs for case in run]
        others |= {name: stressed(flat, change) for name, change in STRESS.items()}
    print("\nthe same, generated scenes" + " and all clips under stress" * options.stress)
    print_head(list(others))
    for name, row in rows.items():
        print_row(name, [cell(errors(found, row, options.grouping)) for found in others.values()])


def cell(found: np.ndarray) -> str:
    """Return both mean errors of (cases, 2), and the number of cases without error."""
    objects, trajectories = found.mean(axis=0)
    return f"{objects:.1f}/{trajectories:.1f} ({np.count_nonzero(found[:, 1] == 0)}/{len(found)})"


def print_head(columns: list[str]) -> None:
    print_row("", columns)


def print_row(name: str, columns: list[str]) -> None:
    print(f"{name:44}" + "".join(f"{column:>20}" for column in columns), flush=True)


if __name__ == "__main__":
    main()
