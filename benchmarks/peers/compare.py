"""Scores and time of `moseg` beside what a user would pick instead without weights, on the same frames.

Run ``python benchmarks/peers/compare.py [--dataset synthetic] [--root DIR] [--sequences NAMES] [--quality default]
[--json FILE]``. The peers are the files of this folder, each our own short implementation of a classical method. All
run one after the other in this process, on one thread, from frames on disk (or from the renderer) to label images in
memory; seconds are those of the processor, because a machine may be busy. `moseg` begins with an empty store.

J and Fu are those of `moseg eval`. The peers give masks without identities, and Fu asks for objects: it is computed for
everything that moves as one object and for objects that are connected in space and time, and the better mean counts.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import flow_layers
import flow_threshold
import frame_difference
import gaussian_background
import numpy as np
from moving_objects import LABELLINGS

import moseg
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.scores import SequenceScore, mean_score
from moseg.tasks.metrics import score_sequence
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.datasets.registry import open_dataset
from moseg.workflows.process.resources import pin_threads

OURS = "moseg"
PEERS = {
    "flow-layers": flow_layers.segment,
    "gaussian-background": gaussian_background.segment,
    "frame-difference": frame_difference.segment,
    "flow-threshold": flow_threshold.segment,
}
Method = Callable[[SequenceSource], np.ndarray]
"""Function that returns masks bool or label images (frame, y, x) of a sequence."""


class Measured(NamedTuple):
    """Scores of a sequence by way of labelling, and processor seconds a frame."""

    scores: dict[str, SequenceScore]
    seconds: float


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dataset", default="synthetic", help="data set with annotated masks")
    parser.add_argument("--root", help="its folder")
    parser.add_argument("--sequences", help="only these, separated by commas")
    parser.add_argument("--quality", default="default", help="of moseg: fast, default or best")
    parser.add_argument("--peers", default=",".join(PEERS), help="only these, separated by commas")
    parser.add_argument("--json", type=Path, help="write the figures here too")
    options = parser.parse_args()
    peers = options.peers.split(",")
    if unknown := sorted(set(peers) - set(PEERS)):
        parser.error(f"no peer {', '.join(unknown)}; there are {', '.join(PEERS)}")
    pin_threads()
    sequences = None if options.sequences is None else tuple(options.sequences.split(","))
    try:
        result = compare(options.dataset, options.root, sequences, options.quality, peers)
    except InputError as error:
        parser.error(str(error))
    print_table(result)
    if options.json is not None:
        options.json.write_text(json.dumps(result, indent=1), encoding="utf-8")


def compare(
    dataset: str, root: str | None, sequences: tuple[str, ...] | None, quality: str, peers: Sequence[str]
) -> dict:
    """Return the figures of `moseg` and the peers on every sequence, as the JSON has them; raises InputError."""
    opened = open_dataset(dataset, root, sequences, max_side=PipelineConfig().max_side)
    measured: dict[str, dict[str, Measured]] = {name: {} for name in (OURS, *peers)}
    num_frames = 0
    for name in opened.names:
        source = opened.sequence(name)
        if source.annotations is None:
            raise InputError("no annotated masks", where=f"sequence {name}", expected="a data set with masks")
        num_frames += source.frames.num_frames()
        with tempfile.TemporaryDirectory(prefix="moseg-peers-") as store:
            measured[OURS][name] = measure(source, lambda source, store=store: ours(source, quality, store))
        for peer in peers:
            measured[peer][name] = measure(source, lambda source, peer=peer: masks_of(source, peer))
        print(f"{name}: done", flush=True)
    figures = {method: summary(by_sequence) for method, by_sequence in measured.items()}
    for each in figures.values():
        each["ratio"] = each["seconds_a_frame"] / figures[OURS]["seconds_a_frame"]
    return {"dataset": opened.name, "quality": quality, "num_frames": num_frames, "methods": figures}


def ours(source: SequenceSource, quality: str, store: str) -> np.ndarray:
    """Return the labels of `moseg`, computed in this process."""
    return moseg.segment_video(source.frames.read(), quality=quality, store=store, progress=False).labels


def masks_of(source: SequenceSource, peer: str) -> np.ndarray:
    """Return the masks of a peer."""
    return np.stack(list(PEERS[peer](list(source.frames.read()))))


def measure(source: SequenceSource, method: Method) -> Measured:
    """Run a method on a sequence, and score what it finds."""
    started = time.process_time()
    found = method(source)
    seconds = (time.process_time() - started) / len(found)
    if found.dtype != bool:
        return Measured({"own": score(source, found)}, seconds)
    return Measured({name: score(source, label(found)) for name, label in LABELLINGS.items()}, seconds)


def score(source: SequenceSource, labels: np.ndarray) -> SequenceScore:
    """Return the scores of label images (frame, y, x) of a sequence."""
    return score_sequence(lambda: ((labels[t], truth) for t, truth in source.annotations.read()), void=source.void)


def summary(measured: dict[str, Measured]) -> dict:
    """Return the means over sequences, and each sequence's scores, by the labelling that is best on average."""
    ways = next(iter(measured.values())).scores
    means = {way: mean_score([each.scores[way] for each in measured.values()]) for way in ways}
    best = max(means, key=lambda way: means[way].F)
    return {
        "J": means[best].J,
        "Fu": means[best].F,
        "objects": best,
        "seconds_a_frame": float(np.mean([each.seconds for each in measured.values()])),
        "sequences": {
            name: {"J": each.scores[best].J, "Fu": each.scores[best].F, "seconds_a_frame": each.seconds}
            for name, each in measured.items()
        },
    }


def print_table(result: dict) -> None:
    """Print J and Fu, percent, processor seconds a frame and their ratio to ours."""
    print(f"{result['dataset']}, {result['num_frames']} frames, moseg with --quality {result['quality']}")
    print(f"{'':22}{'J':>7}{'Fu':>7}{'s/frame':>10}{'ratio':>8}")
    for name, each in result["methods"].items():
        print(f"{name:22}{each['J']:7.1f}{each['Fu']:7.1f}{each['seconds_a_frame']:10.3f}{each['ratio']:8.2f}")


if __name__ == "__main__":
    main()
