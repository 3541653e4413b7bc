"""Each network of the published size, with random weights, on an accelerator: does it run there, and what differs.

Run ``python benchmarks/networks/devices.py --device cuda --out FILE [NAME ...]``. Production's code builds a network
and runs it on the device in production's precision (``moseg.workflows.process.devices.network_context``), on the device
in float32, and on the CPU, where that does not take minutes. Networks run side by side, each in a process of its own;
only one is timed at a time. The table compares, of each network:

- ``half``: the outputs in production's precision with those in float32, both of the device
- ``CPU``: the outputs in float32 with those of the CPU: the largest relative difference (L2) of an output of a module
  that the backend calls
- ``result``: what the backend makes of the outputs, in production's precision and in float32
- ``largest``: the largest output of a module in half precision, which ends at 65504
- seconds a frame after the other runs, which warm up; the same with eight frames in one pass; and the peak of the
  device's memory

Thresholds mean nothing with random weights, so differences are reported and not judged. A network fails if it raises an
error, or if an output is not finite which is finite in float32. FILE gets all of it as JSON, with the traces.
"""

import argparse
import fcntl
import importlib
import json
import multiprocessing
import os
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

BATCH = 8
REPETITIONS = 2
GIB = 2**30
MINUTES_ON_CPU = ("sam2.1-hiera-tiny-video", "sam2.1-hiera-large-video", "sam3", "sam3-video")
"""Networks that take minutes on the CPU, and are compared on the device only."""
SLOWEST = ("sam3", "sam3-video", "bootstapir", "deaot-r50-l", "sam-hq-vit-large", "sam2.1-hiera-large", "edgetam-video")
"""Networks that start first."""
HEADER = ("network", "half", "CPU", "result", "largest", "s/frame", f"s/frame of {BATCH}", "GiB")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="networks, all but those @light by default")
    parser.add_argument("--device", default="cuda", help="cuda, cuda:N, mps or cpu")
    parser.add_argument("--out", type=Path, required=True, help="JSON file to write")
    parser.add_argument("--without-cpu", action="store_true", help="leave out the comparison with the CPU")
    parser.add_argument("--seconds", type=float, default=600, help="after which what still runs is ended")
    parser.add_argument("--jobs", type=int, default=max(len(os.sched_getaffinity(0)) // 2, 1), help="processes")
    options = parser.parse_args()
    # Imports of torch and transformers take seconds, and are done once; nothing has run when the processes fork.
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["cases", "comparison"])
    sys.path.insert(0, str(Path(__file__).parent))
    cost = importlib.import_module("cost")
    known = [name for name in cost.NAMES if options.names or "@" not in name]
    unknown = sorted(set(options.names) - set(known))
    if unknown:
        parser.error(f"no network {', '.join(unknown)}")
    names = sorted(options.names or known, key=lambda name: SLOWEST.index(name) if name in SLOWEST else len(SLOWEST))
    with tempfile.TemporaryDirectory() as folder:
        threads = max(len(os.sched_getaffinity(0)) // options.jobs, 1)
        run_all(
            context,
            names,
            options.jobs,
            options.seconds,
            (Path(folder), options.device, threads, not options.without_cpu),
        )
        found = {name: read(Path(folder), name) for name in names}
    options.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(*map(format_row, (HEADER, ["---"] * len(HEADER))), sep="\n")
    for name in sorted(names, key=cost.NAMES.index):
        print(format_row(describe(name, found[name])))
    failed = [name for name in names if found[name]["failures"]]
    print(f"{len(names) - len(failed)} of {len(names)} run; failed: {', '.join(failed) or 'none'}")
    return int(bool(failed))


def run_all(context, names: list[str], jobs: int, seconds: float, arguments: tuple) -> None:
    """Run networks in processes, some at a time, until the time is over."""
    waiting, running = list(names), {}
    end = time.monotonic() + seconds
    while (waiting or running) and time.monotonic() < end:
        while waiting and len(running) < jobs:
            name = waiting.pop(0)
            running[name] = context.Process(target=measure, args=(name, *arguments))
            running[name].start()
        for name, process in list(running.items()):
            if process.exitcode is not None:
                del running[name]
                print(f"{seconds - end + time.monotonic():5.0f} s  {name} ended with {process.exitcode}", flush=True)
        time.sleep(0.05)
    for name, process in running.items():
        process.kill()
        print(f"{name} was ended because the time is over", flush=True)
    if waiting:
        print(f"no time for {', '.join(waiting)}", flush=True)


def measure(name: str, folder: Path, device: str, threads: int, has_cpu: bool) -> None:
    """Write what one network does into ``NAME.json`` of a folder, after each step, so that a crash leaves the rest."""
    torch, cv2, cases, devices = map(
        importlib.import_module, ("torch", "cv2", "cases", "moseg.workflows.process.devices")
    )
    torch.set_num_threads(threads)
    cv2.setNumThreads(1)
    torch.manual_seed(0)
    devices.set_device(device)
    trial = Trial(cases.CASES[name], name in cases.BATCHED, devices.current_device(), folder)
    for step in (trial.build, trial.compare, trial.compare_batch, trial.time, trial.compare_with_cpu):
        if step == trial.compare_with_cpu and (name in MINUTES_ON_CPU or not has_cpu):
            continue
        trial.found["during"] = step.__name__
        write(folder, name, trial.found)
        start = time.monotonic()
        try:
            step()
        except Exception as error:
            trial.found["failures"].append(f"{step.__name__}: {type(error).__name__}: {error}".splitlines()[0])
            trial.found["traces"].append(traceback.format_exc())
            if step == trial.build:
                break
        trial.found["seconds"][step.__name__] = round(time.monotonic() - start, 2)
    trial.found["during"] = None
    write(folder, name, trial.found)


class Trial:
    """One network and what was found about it."""

    def __init__(self, case: Any, takes_batches: bool, device: Any, folder: Path):
        self._torch, self._cases, self._comparison, self._devices = map(
            importlib.import_module, ("torch", "cases", "comparison", "moseg.workflows.process.devices")
        )
        self._case, self._takes_batches, self._device, self._folder = case, takes_batches, device, folder
        self._network = self._result = self._single = self._single_result = None
        self.found: dict[str, Any] = {"failures": [], "seconds": {}, "traces": []}

    def build(self) -> None:
        network = self._case.build(self._case.make_checkpoint())
        # Not all published ones initialise all of their parameters.
        self._comparison.replace_non_finite(network)
        self._network = network.to(self._device)

    def compare(self) -> None:
        """Compare production's precision with float32, both on the device."""
        with turn(self._folder, is_alone=False):
            half, self._result = self._run(self._device, "production")
            self._note_memory("gib")
            self._single, self._single_result = self._run(self._device, "single")
        compare_results, is_finite = self._comparison.compare_results, self._comparison.is_finite
        self.found["half"] = half.differences(self._single)
        self.found["result"] = compare_results(self._result, self._single_result)
        self.found["largest_half"] = half.largest(self._torch.float16)
        self.found["non_finite"], self.found["non_finite_single"] = half.non_finite(), self._single.non_finite()
        failures = self.found["failures"]
        if bad := [module for module in half.non_finite() if module not in self._single.non_finite()]:
            failures.append(f"not finite in half precision: {', '.join(bad[:3])} ({len(bad)} modules)")
        if not is_finite(self._result):
            failures.append(f"the result is not finite; in float32 finite: {is_finite(self._single_result)}")

    def compare_batch(self) -> None:
        """Compare the first frame of several in one pass with that frame alone."""
        if self._takes_batches and self._result is not None:
            with turn(self._folder, is_alone=False):
                _, batch = self._run(self._device, "production", BATCH)
                self._note_memory("gib_batch")
            self.found["batch_result"] = self._comparison.compare_results(batch[:1], self._result)

    def time(self) -> None:
        with turn(self._folder, is_alone=True):
            self.found["s_per_frame"] = self._time_frames()
            if self._takes_batches:
                self.found["s_per_frame_batch"] = self._time_frames(BATCH)

    def compare_with_cpu(self) -> None:
        """Compare float32 of the device with that of the CPU."""
        if self._device.type == "cpu" or self._single is None:
            return
        self._network = self._network.to("cpu")
        cpu, result = self._run(self._torch.device("cpu"), "single")
        self.found["cpu"] = self._single.differences(cpu)
        self.found["non_finite_cpu"] = cpu.non_finite()
        self.found["cpu_result"] = self._comparison.compare_results(self._single_result, result)

    def _run(self, device: Any, precision: str, *batch: int) -> tuple[Any, Any]:
        """Run the case; return what its modules gave, and its result."""
        is_single = precision == "single"
        full = self._torch.autocast(device.type, enabled=False) if is_single else nullcontext()
        with self._devices.network_context(device), full, self._comparison.Outputs(self._network) as outputs:
            return outputs, self._case.run(self._network, self._cases.Clock(), *batch)[1]

    def _time_frames(self, *batch: int) -> float:
        seconds = []
        for _ in range(REPETITIONS if self._device.type == "cuda" else 1):
            clock = self._cases.Clock()
            clock.start()
            with self._devices.network_context(self._device):
                num_frames, _ = self._case.run(self._network, clock, *batch)
            if self._device.type == "cuda":
                self._torch.cuda.synchronize()
            seconds.append(clock.read()[0] / num_frames)
        return min(seconds)

    def _note_memory(self, name: str) -> None:
        """Note the peak of the device's memory since it was last noted, the weights included."""
        if self._device.type == "cuda":
            self.found[name] = self._torch.cuda.max_memory_allocated() / GIB
            self._torch.cuda.reset_peak_memory_stats()


@contextmanager
def turn(folder: Path, is_alone: bool) -> Iterator[None]:
    """Use the device, alone or beside others; the system frees the place of a process that ends."""
    with open(folder / "gate", "a") as gate, open(folder / "device", "a") as place:
        # Without the gate those that may use it together would never let in one that wants to be alone.
        fcntl.flock(gate, fcntl.LOCK_EX)
        fcntl.flock(place, fcntl.LOCK_EX if is_alone else fcntl.LOCK_SH)
        fcntl.flock(gate, fcntl.LOCK_UN)
        yield


def write(folder: Path, name: str, found: dict[str, Any]) -> None:
    path = folder / f"{name}.part"
    path.write_text(json.dumps(found), encoding="utf-8")
    path.replace(folder / f"{name}.json")


def read(folder: Path, name: str) -> dict[str, Any]:
    """Return what a network's process wrote; one that did not come to its end failed, but for the CPU's part."""
    path = folder / f"{name}.json"
    if not path.exists():
        return {"failures": ["did not start"], "traces": [], "seconds": {}}
    found = json.loads(path.read_text(encoding="utf-8"))
    if found["during"] not in (None, "compare_with_cpu"):
        found["failures"].append(f"ended during step {found['during']}")
    return found


def describe(name: str, found: dict[str, Any]) -> tuple[str, ...]:
    """Return the cells of a network's row."""
    if found["failures"] and "s_per_frame" not in found:
        return name, "; ".join(found["failures"])[:300]
    largest = found.get("largest_half")
    result = ", ".join(f"{key} {value:.3g}" for key, value in found.get("result", {}).items())
    return (
        name,
        worst(found.get("half")),
        worst(found.get("cpu")),
        "; ".join([result, *found["failures"]])[:300],
        f"{largest[1]:.3g}" if largest else "",
        *(f"{found[key]:.3f}" if key in found else "" for key in ("s_per_frame", "s_per_frame_batch", "gib")),
    )


def worst(differences: dict[str, float] | None) -> str:
    return f"{max(differences.values()):.1e}" if differences else ""


def format_row(cells) -> str:
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
