"""Errors on disturbed trajectories: random tracks, noise, missing entries.

``python benchmarks/trajectories/robustness.py ROOT [--dataset hopkins155] [--every N] [--seeds N] [--motions gt|auto]
[--disturbances NAME ...] [--workers N] [--json FILE]`` disturbs every N-th clip of a data set and groups its
trajectories with the default parameters. A clip's error is the share of misclassified trajectories that have a label;
random tracks have none. ``docs/tools/draw_curves.py`` draws the JSON.
"""

import argparse
import json
import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
from disturbed_tracks import DISTURBANCES, OUTLIER, Clip, read_clips
from segment_tracks import segment_tracks

from moseg.schemas.configs import PipelineConfig
from moseg.tasks.metrics import clustering_error

FAILED = 10.0
"""Error in percent above which a clip counts as failed."""


class Case(NamedTuple):
    """One clip under one disturbance."""

    clip: Clip
    disturbance: str
    strength: float
    seed: int
    is_given: bool


def error_of(case: Case) -> tuple[float, bool]:
    """Return the error in percent and whether the number of motions is right."""
    disturb = DISTURBANCES[case.disturbance][0]
    # The seed does not depend on the strength, so that curves compare the same draws.
    clip = disturb(case.clip, case.strength, np.random.default_rng([case.seed, *map(ord, case.clip.name)]))
    num_motions = len(set(case.clip.labels.tolist()) - {OUTLIER})
    given = num_motions if case.is_given else None
    found = segment_tracks(clip.points, clip.visible, given, PipelineConfig(), case.seed)
    scored = clip.labels != OUTLIER
    error = clustering_error(found.motion[scored], clip.labels[scored])
    return float(error), found.clustering.num_motions == num_motions


def curve(cases: list[Case], found: list[tuple[float, bool]]) -> dict[str, dict[str, float]]:
    """Return the figures at each strength: mean and median over clips, and the spread of the mean over seeds."""
    points = {}
    for strength in sorted({case.strength for case in cases}):
        own = [(case, each) for case, each in zip(cases, found, strict=True) if case.strength == strength]
        errors = [error for _, (error, _) in own]
        by_seed = {case.seed: [] for case, _ in own}
        for case, (error, _) in own:
            by_seed[case.seed].append(error)
        means = [np.mean(each) for each in by_seed.values()]
        points[f"{strength:g}"] = {
            "error": float(np.mean(errors)),
            "median_error": float(np.median(errors)),
            "failed": float(100 * np.mean(np.array(errors) > FAILED)),
            "num_motions_correct": float(100 * np.mean([is_right for _, (_, is_right) in own])),
            "spread": float(np.std(means, ddof=1)) if len(means) > 1 else 0.0,
        }
    return points


def main() -> None:
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root")
    parser.add_argument("--dataset", default="hopkins155")
    parser.add_argument("--every", type=int, default=1, help="every n-th clip")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--motions", choices=("gt", "auto"), default="gt")
    parser.add_argument("--disturbances", nargs="+", choices=tuple(DISTURBANCES), default=tuple(DISTURBANCES))
    parser.add_argument("--strengths", type=float, nargs="+", help="instead of the usual ones")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--json", type=Path, help="write the curves here too")
    options = parser.parse_args()
    clips = list(read_clips(options.dataset, options.root, options.every))
    curves = {}
    with ProcessPoolExecutor(options.workers, mp_context=get_context("spawn")) as pool:
        for name in options.disturbances:
            cases = [
                Case(clip, name, strength, seed, options.motions == "gt")
                for strength in options.strengths or DISTURBANCES[name][1]
                for clip in clips
                for seed in range(options.seeds)
            ]
            curves[name] = curve(cases, list(pool.map(error_of, cases, chunksize=4)))
            print(f"\n{name:12} {'error':>7} {'median':>7} {'failed':>7} {'right':>7} {'spread':>7}")
            for strength, point in curves[name].items():
                print(f"{strength:>12} " + " ".join(f"{figure:7.2f}" for figure in point.values()), flush=True)
    if options.json is not None:
        result = {"dataset": options.dataset, "clips": len(clips), "motions": options.motions, "curves": curves}
        options.json.write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main()
