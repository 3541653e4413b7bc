"""Figure of the clips on which two-frame geometry fails most: the truth, the groups without and with many frames.

``python benchmarks/trajectories/worst_sequences.py NAME=ROOT ... [--sequences A,B] [--count N] [--store DIR] [--out
FILE]`` segments the clips of data sets of labelled trajectories twice, with the number of motions given: as before
coding lengths and refinements were introduced, and with the default parameters. It prints both errors of each clip,
in percent, and draws the clips with the largest error before. A group has the colour of the motion that it is matched
with, groups without such a motion are grey, and a ring marks a trajectory in a wrong group.
"""

import argparse
from typing import NamedTuple

import cv2
import numpy as np
from PIL import Image

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.parameters import EnergyParams, PieceParams, TrajectoryClusteringParams
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine.session import Session, open_session
from moseg.workflows.graph import TrajectoryGraph
from moseg.workflows.pipelines.leaves import ingest_trajectories
from moseg.workflows.reports.clip_layers import match_groups

BEFORE = TrajectoryClusteringParams(
    energy=EnergyParams(
        gaps=(3,),
        least_unit=0.15,
        cut_weight=0.85,
        coding_weight=0.0,
        motion_weight=0.01,
        chance_weight=0.0,
        free_motions=0,
    ),
    pieces=PieceParams(merged="middle"),
    num_refined=0,
    min_tracks=1,
)
COLOURS = ((178, 114, 0), (0, 159, 230), (115, 158, 0), (167, 121, 204), (0, 94, 213))
"""BGR of the motions, after Okabe and Ito."""
UNMATCHED = (150, 150, 150)
"""BGR of groups without a motion, and of trajectories without a label."""
WIDTH, MAX_HEIGHT, MARGIN, BORDER = 400, 250, 26, 10
"""Size of a panel, its upper margin and its other ones, px."""


class Outcome(NamedTuple):
    """A clip with its groups: labels int (N,) of the truth, before and after; errors before and after, percent."""

    name: str
    points: np.ndarray
    visible: np.ndarray
    labels: tuple[np.ndarray, np.ndarray, np.ndarray]
    errors: tuple[float, float]


def segment_clips(session: Session, dataset: str, root: str, names: list[str]) -> list[Outcome]:
    """Segment clips of a data set in both ways; without names, all that are on disk."""
    default = PipelineConfig()
    given = default.clustering.model_copy(update={"motions": "gt"})
    configs = [
        default.model_copy(update={"clustering": given, "trajectory_clustering": params})
        for params in (BEFORE, default.trajectory_clustering)
    ]
    opened = open_dataset(dataset, root, max_side=default.max_side)
    sources = [opened.trajectories(name) for name in opened.names if not names or name in names]
    outcomes: list[Outcome] = []
    clips, graphs = [], []

    def build():
        clips[:] = ingest_trajectories(session, sources)
        graphs[:] = [[TrajectoryGraph(leaves, config) for config in configs] for leaves in clips]
        refs = [graph.score(TrajectoryVariant.FUSED) for pair in graphs for graph in pair]
        return {key: value for pair in graphs for graph in pair for key, value in graph.recipes.items()}, tuple(refs)

    def read():
        outcomes.clear()
        for source, pair in zip(sources, graphs, strict=True):
            points, visible = source.trajectories.read()
            truth = source.labels.read().astype(int)
            motions = [session.store.read(graph.clustering(TrajectoryVariant.FUSED), "motion") for graph in pair]
            errors = [session.store.attributes(graph.score(TrajectoryVariant.FUSED))["error"] for graph in pair]
            labels = (truth, *(motion.astype(int) for motion in motions))
            outcomes.append(Outcome(source.name, points, visible, labels, tuple(errors)))

    session.compute(build, read)
    return outcomes


def draw_outcome(outcome: Outcome) -> np.ndarray:
    """Draw the trajectories of a clip three times, coloured by group: uint8 (height, 3 WIDTH, 3)."""
    truth, *found = outcome.labels
    partners = [match_groups(labels, truth) for labels in found]
    # In the labels of the truth; -1 has no partner.
    matched = [
        np.array([partner.get(label, -1) for label in labels.tolist()])
        for partner, labels in zip(partners, found, strict=True)
    ]
    errors = (f"{name} {error:.1f} %" for name, error in zip(("before", "after"), outcome.errors, strict=True))
    panels = [
        _draw_groups(outcome, labels, (labels != truth) & (truth > 0), f"{outcome.name}: {title}")
        for labels, title in zip((truth, *matched), ("truth", *errors), strict=True)
    ]
    return np.hstack(panels)


def _draw_groups(outcome: Outcome, labels: np.ndarray, is_wrong: np.ndarray, title: str) -> np.ndarray:
    """Draw the trajectories over the whole clip, with a dot in the middle of each, and a ring around wrong ones."""
    seen = outcome.points[outcome.visible]
    low, extent = seen.min(axis=0), np.ptp(seen, axis=0)
    scale = min((WIDTH - 2 * BORDER) / extent[0], (MAX_HEIGHT - MARGIN - BORDER) / extent[1])
    picture = np.full((round(MARGIN + BORDER + scale * extent[1]), WIDTH, 3), 255, np.uint8)
    rings = []
    for track, is_visible, label, wrong in zip(outcome.points, outcome.visible, labels, is_wrong, strict=True):
        places = ((track[is_visible] - low) * scale + (BORDER, MARGIN)).round().astype(np.int32)
        if not len(places):
            continue
        colour = COLOURS[(label - 1) % len(COLOURS)] if label > 0 else UNMATCHED
        pale = tuple((255 + value) // 2 for value in colour)
        middle = places[len(places) // 2].tolist()
        cv2.polylines(picture, [places.reshape(-1, 1, 2)], False, pale, 1, cv2.LINE_AA)
        cv2.circle(picture, middle, 2, colour, -1, cv2.LINE_AA)
        rings += [middle] if wrong else []
    for middle in rings:
        cv2.circle(picture, middle, 3, (0, 0, 0), 1, cv2.LINE_AA)
    cv2.putText(picture, title, (BORDER, 18), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (0, 0, 0), 1, cv2.LINE_AA)
    return picture


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("datasets", nargs="+", metavar="NAME=ROOT")
    parser.add_argument("--sequences", default="", help="names of clips, separated by commas")
    parser.add_argument("--count", type=int, default=4, help="number of clips that are drawn")
    parser.add_argument("--store", default=".moseg/store")
    parser.add_argument("--out", default="docs/images/worst_sequences.png")
    arguments = parser.parse_args()
    names = [name for name in arguments.sequences.split(",") if name]
    with open_session(arguments.store) as session:
        outcomes = [
            outcome
            for dataset, _, root in (each.partition("=") for each in arguments.datasets)
            for outcome in segment_clips(session, dataset, root, names)
        ]
    outcomes.sort(key=lambda outcome: -outcome.errors[0])
    for outcome in outcomes:
        print(f"{outcome.name:30s} before {outcome.errors[0]:5.1f}  after {outcome.errors[1]:5.1f}")
    drawn = np.vstack([draw_outcome(outcome) for outcome in outcomes[: arguments.count]])
    picture = Image.fromarray(cv2.cvtColor(drawn, cv2.COLOR_BGR2RGB))
    # Few colours in a fraction of the space; an octree keeps the rare ones.
    picture.quantize(64, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
