"""Time and memory of evaluations by number of frame pairs, and of the plan of ten thousand pairs.

Run ``python benchmarks/scale.py [--pairs 100,1000,10000] [--one-video] [--workers N]``; the default, 100 and 1,000
pairs, takes about two minutes, 10,000 another seven. Frames are 64 x 48 px, so that growth with the number of pairs is
that of the engine, not of the arrays. The pipeline has all default parameters.

*Plans.* A plan leads from given leaves (the digests of decoded frames) to the list of tasks to compute: it writes the
recipes of every sequence, digests them to keys, and looks them up in the store. Printed are seconds
of a cold plan, on an empty store, and of a warm one, on a store that holds all sinks (the scores and the cues that an
evaluation asks for); and of the pin that protects a cold plan's artifacts from a collection. Then: inputs that a recipe
has on average, the memory of the plan (made again, while Python counts what it allocates), and the names in its pin and
their size. Leaves are made up.

*Calls.* Functions that do nothing are run through a scheduler by one worker. Printed are the processor's time of each
process for a call, and how much larger each became.

*Runs.* Each size has a folder of videos, an empty store, and a scheduler and workers of its own, in processes of their
own. Printed are the time on the wall and of all processors, the wall time of the same run again (warm), and the largest
resident memory of the client, the scheduler and a worker; then, per pair, the same minus those of a nearly
empty run (one video of two pairs), which includes interpreters, imports and first use. Time per pair should not grow.
Memory per pair is constant if memory grows with the pairs, and decreases if memory is bounded.
"""

import argparse
import gc
import shutil
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Sequence
from pathlib import Path

from engine.empty_calls import measure_calls
from engine.measured_run import measure

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_json
from moseg.store import LocalStore
from moseg.workflows.engine.planning import Plan, make_plan
from moseg.workflows.graph import SequenceGraph, SequenceLeaves

SIZE = (48, 64)
MIB = 2**20
LEASE_SECONDS = 3600.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", default="100,1000", help="sizes of the runs, separated by commas")
    parser.add_argument("--plan-pairs", default="1000,10000", help="sizes of the plans")
    parser.add_argument("--calls", default="2000", help="numbers of empty calls")
    parser.add_argument("--video-pairs", type=int, default=100, help="frame pairs of a video")
    parser.add_argument("--one-video", action="store_true", help="all pairs in one video")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--scratch", type=Path, default=None, help="folder for videos and stores, until the end")
    options = parser.parse_args()
    scratch = Path(tempfile.mkdtemp(prefix="moseg-bench-", dir=options.scratch))

    def shape(num_pairs: int) -> tuple[int, int]:
        per_video = num_pairs if options.one_video else min(num_pairs, options.video_pairs)
        return num_pairs // per_video, per_video

    try:
        report_plans([shape(int(text)) for text in options.plan_pairs.split(",") if text], scratch)
        report_calls([int(text) for text in options.calls.split(",") if text], scratch)
        if options.pairs:
            report_runs([shape(int(text)) for text in options.pairs.split(",")], options.workers, scratch)
    finally:
        shutil.rmtree(scratch)
    return 0


def report_plans(shapes: Sequence[tuple[int, int]], scratch: Path) -> None:
    """Print seconds of plans; targets for 10,000 pairs are 5 s cold and 1 s warm."""
    head = ("pairs", "videos", "nodes", "sinks")
    head += ("cold plan", "of it look-ups", "its pin", "warm plan", "of it look-ups")
    head += ("inputs a recipe", "memory a pair", "names in its pin", "bytes a name")
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}", flush=True)
    for num_videos, per_video in shapes:
        store = LocalStore(scratch / f"plan-{num_videos}x{per_video}")
        leaves = [make_up_leaves(video, per_video) for video in range(num_videos)]
        plan, sinks, cold, cold_look = plan_timed(store, leaves)
        start = time.perf_counter()
        store.pin("benchmark", plan.touched(), lease_seconds=LEASE_SECONDS)
        pin = time.perf_counter() - start
        num_pairs, names = num_videos * per_video, len(plan.touched())
        pin_bytes = sum(path.stat().st_size for path in (Path(store.url) / "pins").iterdir())
        inputs = sum(len(recipe.input_refs()) for recipe in plan.compute.values()) / len(plan.compute)
        memory = plan_memory(store, num_videos, per_video)
        sizes = f"{inputs:.1f} | {memory / num_pairs / 1024:.1f} KiB | {names} | {pin_bytes / names:.0f}"
        for ref in sinks:
            store.put(plan.compute[ref], {}, dims={})
        counts = f"{num_pairs} | {num_videos} | {len(plan.compute)} | {len(sinks)}"
        # A process that plans once has no other plan for the garbage collector to traverse.
        del plan
        gc.collect()
        again, _, warm, warm_look = plan_timed(store, leaves)
        if again.compute:
            raise ValueError("a warm plan must be empty")
        times = " | ".join(f"{seconds:.2f} s" for seconds in (cold, cold_look, pin, warm, warm_look))
        print(f"| {counts} | {times} | {sizes} |", flush=True)


def plan_memory(store: LocalStore, num_videos: int, per_video: int) -> int:
    """Return the bytes that Python allocates for a plan, for its leaves and for its recipes, and does not free."""
    gc.collect()
    tracemalloc.start()
    kept = plan_timed(store, [make_up_leaves(video, per_video) for video in range(num_videos)])
    gc.collect()
    nbytes = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    del kept
    return nbytes


def plan_timed(store: LocalStore, leaves: Sequence[SequenceLeaves]) -> tuple[Plan, list[str], float, float]:
    """Return the plan of an evaluation of these sequences, its sinks, and the seconds in all and of the look-ups."""
    config = PipelineConfig()
    start = time.perf_counter()
    recipes, sinks = {}, []
    for each in leaves:
        graph = SequenceGraph(each, config)
        sinks += [graph.score(Variant.FUSED), *graph.cues()]
        recipes |= graph.recipes
    keyed = time.perf_counter()
    plan = make_plan(store, recipes, sinks)
    end = time.perf_counter()
    return plan, sinks, end - start, end - keyed


def make_up_leaves(video: int, num_pairs: int) -> SequenceLeaves:
    """Return made-up leaves of a sequence."""
    frames = tuple(f"frame/{digest_json('made-up', [video, t])}" for t in range(num_pairs + 1))
    annotation = f"annotation/{digest_json('made-up', video)}"
    weights = f"motion_weights/{digest_json('made-up', None)}"
    return SequenceLeaves(
        f"video-{video:05}", SIZE, frames, annotation=annotation, num_motions=2, motion_weights=weights
    )


def report_calls(counts: Sequence[int], scratch: Path) -> None:
    """Print the cost of empty calls in each process."""
    print("\n| empty calls | process | CPU of a call | larger by |\n|---|---|---|---|", flush=True)
    for count in counts:
        folder = scratch / f"calls-{count}"
        folder.mkdir()
        for role, cost in measure_calls(count, folder).items():
            print(f"| {count} | {role} | {1e3 * cost.cpu:.2f} ms | {cost.grown / MIB:.1f} MiB |", flush=True)


def report_runs(shapes: Sequence[tuple[int, int]], workers: int, scratch: Path) -> None:
    """Print the cost of runs of these sizes, and the cost per pair minus that of a nearly empty run."""
    print(f"\nruns with {workers} worker(s), the first nearly empty")
    print("| pairs | videos | artifacts | MB | wall | CPU | warm | client | scheduler | worker |")
    print("|---|---|---|---|---|---|---|---|---|---|", flush=True)
    empty, rows = None, []
    for num_videos, per_video in [(1, 2), *shapes]:
        num_pairs = num_videos * per_video
        cost = measure(num_videos, per_video, SIZE, workers, scratch)
        counts = f"{num_pairs} | {num_videos} | {cost.num_artifacts} | {cost.nbytes / 1e6:.1f}"
        peaks = " | ".join(f"{peak / MIB:.0f} MiB" for peak in cost.peaks)
        print(f"| {counts} | {cost.wall:.1f} s | {cost.cpu:.1f} s | {cost.warm:.1f} s | {peaks} |", flush=True)
        if empty is None:
            empty = cost
            continue
        kib = [(peak - least) / 1024 / num_pairs for peak, least in zip(cost.peaks, empty.peaks, strict=True)]
        rows.append([num_pairs, (cost.wall - empty.wall) / num_pairs, (cost.cpu - empty.cpu) / num_pairs, *kib])
    print("\na pair, without the nearly empty run (in brackets: over the first size's)")
    print("| pairs | wall, s | CPU, s | client, KiB | scheduler, KiB | worker, KiB |\n|---|---|---|---|---|---|")
    for num_pairs, *values in rows:
        columns = [f"{value:.3g} ({value / first:.2f})" for value, first in zip(values, rows[0][1:], strict=True)]
        print(f"| {num_pairs} | {' | '.join(columns)} |")


if __name__ == "__main__":
    sys.exit(main())
