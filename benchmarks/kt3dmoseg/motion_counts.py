"""Accuracy of the number of motions found on KT3DMoSeg, with objects of one motion each.

``python benchmarks/kt3dmoseg/motion_counts.py [ROOT] [--seeds N] [--methods NAME ...] [--set NAME=VALUE ...] [--sweep
NAME=V,V]`` prints for each method how often it finds the right number of motions (percent of clips and seeds): for the
three partitions of ``object_partitions.py``, and, where the right number is 1, for the objects of the background alone
and for synthetic objects that stand still. ``--sweep`` repeats a method for several values of one of its parameters,
and prints the result if each clip has the value that is best on all other clips.
"""

import argparse
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from object_affinities import group
from object_partitions import PARTITIONS, Case, Clip, cases, read_clips

from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.affinity import hypothesis_affinity
from moseg.tasks.clustering import CountEvidence, MotionTracks, count_motions
from moseg.tasks.clustering.count_motions import count_by_eigengap
from moseg.tasks.clustering.fusion import fill_unknown
from moseg.tasks.clustering.spectral import embed_views
from moseg.tasks.clustering.stability import resampled_affinities
from moseg.tasks.synthetic.rigid_tracks import rigid_tracks

METHODS = ("description_length", "geometric", "confidences", "stability", "eigengap")
NUM_SYNTHETIC = 10
"""Number of static scenes for each level of noise."""
NOISES = (0.0, 0.1, 0.5)
"""px."""


def all_cases(root: Path, seed: int) -> Iterator[tuple[str, int, Case]]:
    """Return all cases, with the name of their column and the number of their clip or scene."""
    clips = read_clips(root)
    backgrounds = [Clip(*(array[clip.motion == 0] for array in clip)) for clip in clips]
    for partition in PARTITIONS:
        for number, case in enumerate(cases(clips, partition, seed)):
            yield partition, number, case
    for partition in ("one", "big"):
        for number, case in enumerate(cases(backgrounds, partition, seed)):
            yield f"static {partition}", number, case
    for noise in NOISES:
        for number in range(NUM_SYNTHETIC):
            tracks = rigid_tracks([8], 10, 25, noise, np.random.default_rng([seed, number]))
            yield f"static {noise} px", number, Case(*tracks)


def evidence_of(case: Case, resample: bool, params: MotionCountParams, seed: int) -> CountEvidence:
    """Return all inputs that a method may read; resamples only on demand."""
    max_motions = min(params.most_motions, case.num_objects)
    affinity_params = HypothesisAffinityParams()
    rng = np.random.default_rng(seed)
    affinity = hypothesis_affinity(case.points, case.visible, case.owner, case.num_objects, affinity_params, rng)
    tracks = (MotionTracks(case.points, case.visible, case.owner),)
    others = resampled_affinities(tracks, case.num_objects, params, rng) if resample else []

    def labelings(matrix: np.ndarray) -> list[np.ndarray]:
        return [group(matrix, count, "linkage") for count in range(1, max_motions + 1)]

    kernel = fill_unknown([affinity])[0]
    eigenvalues = embed_views(kernel[None], 1).eigenvalues
    return CountEvidence(labelings(affinity), kernel, eigenvalues, tracks, [labelings(other) for other in others])


def count(evidence: CountEvidence, method: str, params: MotionCountParams, seed: int) -> int:
    if method == "eigengap":
        return count_by_eigengap(evidence.eigenvalues)
    return count_motions(evidence, method, params, np.random.default_rng(seed)).num_motions


def row(name: str, right: dict[str, list[bool]]) -> str:
    shares = "".join(f"{100 * np.mean(found):14.0f}" for found in right.values())
    return f"{name:44s}{shares}"


def left_out(found: list[dict[str, dict[int, list[bool]]]]) -> dict[str, list[bool]]:
    """Return the rights of each clip under the setting that is right most often on all others, by column.

    `found` is for each setting {column: {clip: rights}}, of labelled clips alone.
    """
    clips = sorted({clip for columns in found for rows in columns.values() for clip in rows})
    chosen: dict[str, list[bool]] = {}
    for clip in clips:
        scores = [
            np.mean([np.mean(rights) for rows in columns.values() for other, rights in rows.items() if other != clip])
            for columns in found
        ]
        for column, rows in found[int(np.argmax(scores))].items():
            chosen.setdefault(column, []).extend(rows[clip])
    return chosen


def main() -> None:
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", nargs="?", type=Path, default=Path(os.environ.get("MOSEG_DATA", "."), "kt3dmoseg"))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", dest="values")
    parser.add_argument("--sweep", nargs="+", default=[], metavar="NAME=V,V")
    arguments = parser.parse_args()
    base = dict(value.split("=") for value in arguments.values)
    settings = [base]
    for sweep in arguments.sweep:
        name, values = sweep.split("=")
        settings = [{**setting, name: value} for setting in settings for value in values.split(",")]

    rights: dict[tuple[str, int], dict[str, dict[int, list[bool]]]] = {}
    for seed in range(arguments.seeds):
        for column, clip, case in all_cases(arguments.root, seed):
            evidence = evidence_of(case, "stability" in arguments.methods, MotionCountParams(**base), seed)
            for method in arguments.methods:
                for index, setting in enumerate(settings):
                    is_right = count(evidence, method, MotionCountParams(**setting), seed) == case.num_motions
                    columns = rights.setdefault((method, index), {})
                    columns.setdefault(column, {}).setdefault(clip, []).append(is_right)
    any_columns = next(iter(rights.values()))
    print(f"{'number of motions right, percent':44s}" + "".join(f"{column:>14s}" for column in any_columns))
    for method in arguments.methods:
        found = [rights[method, index] for index in range(len(settings))]
        for setting, columns in zip(settings, found, strict=True):
            values = " ".join(f"{name}={value}" for name, value in setting.items())
            flat = {column: [right for rows in clips.values() for right in rows] for column, clips in columns.items()}
            print(row(f"{method} {values}", flat))
        if len(settings) > 1:
            labelled = [{name: rows for name, rows in columns.items() if name in PARTITIONS} for columns in found]
            print(row(f"{method}, of the other clips", left_out(labelled)))


if __name__ == "__main__":
    main()
