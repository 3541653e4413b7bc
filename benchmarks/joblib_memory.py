"""Comparison of an evaluation by `joblib.Memory` and by the artifact store: whole runs, cold and warm.

Run ``python benchmarks/joblib_memory.py [--dataset davis16 --root DIR] [--repeat N] [--jobs 2]``; the default, two
small rendered scenes, takes about a minute and a half.

With joblib the evaluation is written in its usual way: every task of our graph, in its order, is one call of a
function that ``Memory.cache`` decorates, with joblib's defaults. Its arguments are the task, its parameters and the
arrays and attributes that it reads, which joblib hashes by content; its result is pickled. Decoding is cached too, by
the digest of the files' bytes, as ours is. The task functions are ours, so the work is the same; what differs is how
results are named, stored, found and passed on: a warm run of joblib repeats every call, hashes its inputs and loads its
result, because the next call reads it. In joblib's favour, it builds no graph, because the list of calls is made
beforehand, and it keeps results in memory for later calls. The benchmark checks that the scores are equal.

Both run in one process, which has imported all modules; their order alternates between rounds, and the medians of the
rounds' times and ratios are printed. With ``--jobs``, sequences are spread by ``joblib.Parallel`` over so many
processes, against as many workers; each run includes the start and end of both (ours starts none if nothing is to be
computed).
"""

import argparse
import json
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import joblib
import numpy as np
from engine.memory_inputs import Artifact, MemoryInputs
from joblib.externals.loky import get_reusable_executor

from moseg.schemas.arrays import round_arrays
from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.recipes import Recipe
from moseg.schemas.scores import SequenceScore
from moseg.workflows.datasets import SequenceSource, open_dataset
from moseg.workflows.engine.execution import seeded_generator
from moseg.workflows.engine.planning import make_plan
from moseg.workflows.engine.session import open_session
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.evaluate import evaluate
from moseg.workflows.pipelines.leaves import FRAMES_PER_JOB, ingest_sequences
from moseg.workflows.process.resources import pin_threads
from moseg.workflows.sources import MotionWeights
from moseg.workflows.stages.registry import find_task, layouts_of


class Step(NamedTuple):
    """Task of a sequence in the order of the plan, with the names of its inputs."""

    ref: str
    task: str
    params: dict[str, Any]
    inputs: dict[str, str | tuple[str, ...]]
    key: str


class Script(NamedTuple):
    """Calls of one sequence by joblib: its decoded content and the names of that, the steps and the score's name."""

    source: SequenceSource
    frames: tuple[str, ...]
    annotation: str
    network: MotionWeights
    motion_weights: str
    steps: tuple[Step, ...]
    score: str


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dataset", default="synthetic")
    parser.add_argument("--root", default=None, help="the data set's folder")
    parser.add_argument("--sequences", default=None, help="only these, separated by commas (synthetic: two scenes)")
    parser.add_argument("--repeat", type=int, default=3, help="rounds")
    parser.add_argument("--jobs", type=int, default=1, help="processes on both sides; 1 is the process itself")
    parser.add_argument("--scratch", type=Path, default=None, help="folder for the stores, until the end")
    options = parser.parse_args()
    names = options.sequences or ("two-motions,crossing-movers" if options.dataset == "synthetic" else None)
    config = PipelineConfig()
    chosen = tuple(names.split(",")) if names else None
    dataset = open_dataset(options.dataset, options.root, chosen, max_side=config.max_side)
    sources = [dataset.sequence(name) for name in dataset.names]
    pin_threads(1)
    scratch = Path(tempfile.mkdtemp(prefix="moseg-bench-", dir=options.scratch))
    try:
        scripts = write_scripts(sources, config, scratch / "scripts")
        rounds = []
        for number in range(options.repeat):
            runs = {
                "ours": lambda: run_ours(sources, config, scratch / "ours", options.jobs),
                "joblib": lambda: run_joblib(scripts, scratch / "joblib", options.jobs),
            }
            rounds.append(compare(dict(list(runs.items())[:: -1 if number % 2 else 1]), scratch))
    finally:
        shutil.rmtree(scratch)
    num_steps = sum(len(script.steps) for script in scripts)
    print(f"{len(sources)} sequences, {num_steps} tasks, {options.jobs} processes, medians of {options.repeat}")
    print("| run | moseg | joblib.Memory | joblib over moseg |\n|---|---|---|---|")
    for kind, unit in (("cold", "s"), ("warm", "s"), ("on disk", "MB")):
        ours, theirs, ratio = (median(values) for values in zip(*(each[kind] for each in rounds), strict=True))
        print(f"| {kind} | {ours:.2f} {unit} | {theirs:.2f} {unit} | {ratio:.2f} |")
    return 0


def write_scripts(sources: Sequence[SequenceSource], config: PipelineConfig, root: Path) -> list[Script]:
    """Return the calls for joblib, from our graph, which stores only leaves for them."""
    scripts = []
    with open_session(str(root), quiet=True) as session:
        for source, leaves in zip(sources, ingest_sequences(session, sources, config, annotated=True), strict=True):
            graph = SequenceGraph(leaves, config)
            score = graph.score(Variant.FUSED)
            plan = make_plan(session.store, graph.recipes, [score, *graph.cues()])
            steps = tuple(map(_write_step, plan.compute.values()))
            network = MotionWeights(config.motion_network.weights)
            scripts.append(
                Script(source, leaves.frames, leaves.annotation, network, leaves.motion_weights, steps, score)
            )
    return scripts


def compare(runs: Mapping[str, Callable[[], list[SequenceScore]]], scratch: Path) -> dict[str, tuple[float, ...]]:
    """Return ours, joblib's and their ratio: seconds of a cold and a warm run in the order of `runs`, and megabytes
    on disk."""
    found = {}
    for kind in ("cold", "warm"):
        seconds, scores = {}, {}
        for side, run in runs.items():
            start = time.perf_counter()
            scores[side] = run()
            seconds[side] = time.perf_counter() - start
        if scores["ours"] != scores["joblib"]:
            raise ValueError("both sides must give the same scores")
        found[kind] = (seconds["ours"], seconds["joblib"], seconds["joblib"] / seconds["ours"])
    ours, theirs = (_megabytes(scratch / side) for side in ("ours", "joblib"))
    found["on disk"] = (ours, theirs, theirs / ours)
    for side in runs:
        shutil.rmtree(scratch / side)
    return found


def run_ours(sources: Sequence[SequenceSource], config: PipelineConfig, root: Path, jobs: int) -> list[SequenceScore]:
    """Evaluate as `moseg eval` does, and return the score of each sequence."""
    with open_session(str(root), workers=jobs if jobs > 1 else 0, quiet=True) as session:
        report = evaluate(session, "benchmark", sources, config, (Variant.FUSED,))
    return [report.rows[0].sequences[source.name] for source in sources]


def run_joblib(scripts: Sequence[Script], root: Path, jobs: int) -> list[SequenceScore]:
    """Evaluate by joblib, and return the score of each sequence."""
    calls = [joblib.delayed(run_script)(str(root), script) for script in scripts]
    scores = [SequenceScore(**attributes) for attributes in joblib.Parallel(n_jobs=jobs)(calls)]
    if jobs > 1:
        # Otherwise a later run would reuse the running processes.
        get_reusable_executor().shutdown()
    return scores


def run_script(root: str, script: Script) -> dict:
    """Compute one sequence with every call through joblib's memory."""
    pin_threads(1)
    memory = joblib.Memory(root, verbose=0)
    compute = memory.cache(run_step, ignore=["key"])
    decode = memory.cache(decode_frames, ignore=["source"])
    decode_truth = memory.cache(decode_annotation, ignore=["source"])
    decode_network = memory.cache(decode_weights, ignore=["source"])
    truth, network = script.source.annotations, script.network
    values: dict[str, Artifact] = {
        script.annotation: decode_truth(truth.fingerprint(), truth),
        script.motion_weights: decode_network(network.fingerprint(), network),
    }
    images = []
    for chunk in script.source.frames.chunks(FRAMES_PER_JOB):
        images.extend(decode(chunk.fingerprint(), chunk))
    values |= {ref: ({"image": image}, {}) for ref, image in zip(script.frames, images, strict=True)}
    for step in script.steps:
        inputs = {
            role: values[refs] if isinstance(refs, str) else [values[ref] for ref in refs]
            for role, refs in step.inputs.items()
        }
        values[step.ref] = compute(step.task, step.params, inputs, step.key)
    return values[script.score][1]


def run_step(task: str, params: dict, inputs: dict, key: str) -> Artifact:
    """Compute one task; `key` seeds its random numbers, and is not part of the name of the result in joblib."""
    params = dict(params)
    found = find_task(task, params.pop("method"))
    (output,) = found.compute(params, [MemoryInputs(inputs)], [seeded_generator(key)])
    return round_arrays(output.arrays, layouts_of(task)), dict(output.attributes)


def decode_frames(fingerprint: str, source) -> list[np.ndarray]:
    """Decode the frames of a source; `fingerprint` is the digest of its files' bytes."""
    return list(source.read())


def decode_annotation(fingerprint: str, source) -> Artifact:
    """Decode the ground truth of a sequence, as ingest stores it."""
    indices, masks = zip(*source.read(), strict=True)
    return {"masks": np.stack(masks)}, {"indices": list(map(int, indices))}


def decode_weights(fingerprint: str, source: MotionWeights) -> Artifact:
    """Decode a motion network; `fingerprint` is the digest of its file's bytes."""
    return {"onnx": source.read()}, {}


def _write_step(recipe: Recipe) -> Step:
    # Plain data, as in a usual script.
    params = json.loads(json.dumps(recipe.params))
    return Step(recipe.ref, recipe.task, params, dict(recipe.inputs), recipe.key)


def _megabytes(root: Path) -> float:
    return sum(path.stat().st_size for path in root.rglob("*") if path.is_file()) / 1e6


if __name__ == "__main__":
    sys.exit(main())
