"""Memory and time of each network of the published size, with random weights, at 854 x 480 on one CPU thread.

Run ``python benchmarks/networks/cost.py [NAME ...]``; all take about half an hour. Each network has a process of its
own, in which production's code builds it from a state dict and runs it. A row gives the process's memory before the
run, its peak from the start to the end, weights being read included, and seconds a frame: on the wall, and of the CPU,
which are fair on a busy machine too. A warm-up is left out, but for the rows that say "one run".
"""

import argparse
import importlib
import multiprocessing
import os
import resource
import sys

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
    "deaot-r50-l",
    "pips",
    "raft-large",
    "raft-small",
    "sea-raft-m",
    "sea-raft-s",
    "dpt-dinov2-small",
    "dpt-dinov2-large",
    "depth-anything-v2-small",
)
GIB = 2**30


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"networks, all by default: {', '.join(NAMES)}")
    names = parser.parse_args().names or NAMES
    unknown = sorted(set(names) - set(NAMES))
    if unknown:
        parser.error(f"no network {', '.join(unknown)}")
    os.environ["OMP_NUM_THREADS"] = "1"
    context = multiprocessing.get_context("spawn")
    print("| network | work | before | peak | s/frame | CPU s/frame |\n|---|---|---|---|---|---|", flush=True)
    failed = False
    for name in names:
        process = context.Process(target=measure, args=(name,))
        process.start()
        process.join()
        if process.exitcode:
            print(f"| {name} | failed with exit code {process.exitcode} |", flush=True)
            failed = True
    return int(failed)


def measure(name: str) -> None:
    """Print the row of one network, importing libraries only here, because a process starts with its parent's peak."""
    psutil, cv2, torch, cases = (importlib.import_module(module) for module in ("psutil", "cv2", "torch", "cases"))
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    case = cases.CASES[name]
    network = case.build(case.make_checkpoint())
    before = psutil.Process().memory_info().rss
    clock = cases.Clock()
    clock.start()
    num_frames = case.run(network, clock)
    wall, cpu = (seconds / num_frames for seconds in clock.read())
    # In kilobytes, on macOS in bytes.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    memory = f"{before / GIB:.1f} GiB | {peak / GIB:.1f} GiB"
    print(f"| {name} | {case.work} | {memory} | {wall:.1f} | {cpu:.1f} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
