"""Memory and time of each network of the published size, with random weights, at 854 x 480 on one CPU thread.

Run ``python benchmarks/networks/cost.py [NAME ...] [--write]``; all take about an hour, a third of it for SAM 3. Each
network has a process of its own, in which production's code builds it from a state dict and runs it. A row gives the
process's memory before the run, its peak from the start to the end, weights being read included, and seconds a frame:
on the wall, and of the CPU, which are fair on a busy machine too. A warm-up is left out, but for the rows that say "one
run". NAME@light is a network with the parameters of ``--preset modern --light``.

``--write`` puts the seconds of the CPU into ``workflows/weights/costs.json``, which `moseg backends --why` reads, with
those of RAFT in the same run, because machines and days differ. RAFT's own are recorded only if all run.
"""

import argparse
import importlib
import json
import multiprocessing
import os
import resource
import sys
from multiprocessing.queues import SimpleQueue
from pathlib import Path

NAMES = (
    "ram",
    "ram-plus",
    "grounding-dino-tiny",
    "grounding-dino-base",
    "sam-hq-vit-base",
    "sam-hq-vit-large",
    "sam2.1-hiera-tiny",
    "sam2.1-hiera-large",
    "sam2.1-hiera-tiny-video",
    "sam2.1-hiera-large-video",
    "edgetam",
    "edgetam-video",
    "sam3",
    "sam3-video",
    "deaot-r50-l",
    "pips",
    "bootstapir",
    "bootstapir@light",
    "raft-large",
    "raft-small",
    "sea-raft-m",
    "sea-raft-s",
    "dpt-dinov2-small-nyu",
    "dpt-dinov2-large-nyu",
    "depth-anything-v2-small",
    "depth-anything-3-small",
    "depth-anything-3-base",
    "depth-anything-3-small-views",
    "depth-anything-3-small-rays",
    "depth-anything-3-base-views",
    "depth-anything-3-base-rays",
    "grounding-dino-tiny@light",
    "deaot-r50-l@light",
    "sea-raft-s@light",
)
REFERENCE = "raft-large"
COSTS = Path(__file__).resolve().parents[2] / "workflows" / "weights" / "costs.json"
GIB = 2**30


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"networks, all by default: {', '.join(NAMES)}")
    parser.add_argument("--write", action="store_true", help=f"write the seconds to {COSTS.name}; {REFERENCE} runs too")
    options = parser.parse_args()
    names = tuple(options.names) or NAMES
    if options.write and REFERENCE not in names:
        names = (REFERENCE, *names)
    unknown = sorted(set(names) - set(NAMES))
    if unknown:
        parser.error(f"no network {', '.join(unknown)}")
    os.environ["OMP_NUM_THREADS"] = "1"
    context = multiprocessing.get_context("spawn")
    print("| network | work | before | peak | s/frame | CPU s/frame |\n|---|---|---|---|---|---|", flush=True)
    seconds: dict[str, float] = {}
    for name in names:
        found = context.SimpleQueue()
        process = context.Process(target=measure, args=(name, found))
        process.start()
        process.join()
        if process.exitcode:
            print(f"| {name} | failed with exit code {process.exitcode} |", flush=True)
        else:
            seconds[name] = found.get()
    if options.write and REFERENCE in seconds:
        write(seconds)
    return int(len(seconds) < len(names))


def write(seconds: dict[str, float]) -> None:
    """Put seconds of the CPU a frame, and those of the reference in the same run, into the file; others stay."""
    costs = json.loads(COSTS.read_text(encoding="utf-8"))
    written = seconds if len(seconds) == len(NAMES) else {name: seconds[name] for name in seconds if name != REFERENCE}
    for name, found in written.items():
        costs[name] = {"seconds": round(found, 2), "reference": round(seconds[REFERENCE], 2)}
    COSTS.write_text(json.dumps(dict(sorted(costs.items())), indent=2) + "\n", encoding="utf-8")


def measure(name: str, found: SimpleQueue) -> None:
    """Print the row of one network, and put its seconds of the CPU into `found`.

    Libraries are imported only here, because a process starts with its parent's peak.
    """
    psutil, cv2, torch, cases = (importlib.import_module(module) for module in ("psutil", "cv2", "torch", "cases"))
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    case = cases.CASES[name]
    network = case.build(case.make_checkpoint())
    before = psutil.Process().memory_info().rss
    clock = cases.Clock()
    clock.start()
    num_frames, _ = case.run(network, clock)
    wall, cpu = (seconds / num_frames for seconds in clock.read())
    # In kilobytes, on macOS in bytes.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    memory = f"{before / GIB:.1f} GiB | {peak / GIB:.1f} GiB"
    print(f"| {name} | {case.work} | {memory} | {wall:.1f} | {cpu:.1f} |", flush=True)
    found.put(cpu)


if __name__ == "__main__":
    sys.exit(main())
