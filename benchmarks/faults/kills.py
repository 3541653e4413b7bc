"""Choice of the moment of a kill, and kills at this moment."""

import random
import time
from pathlib import Path
from typing import NamedTuple

from contents import count_artifacts
from deaths import die_at_step
from object_store import ObjectServer
from processes import Run, wait_until
from workload import Workload

EARLY_SHARE, EARLY_SEC = 0.1, 3.0
"""Share of kills while processes start, before anything is stored, and how long starting takes."""
STEP_SHARE = 0.6
"""Share of kills on a step of writing; the others come at any time."""
STEPS_PER_ARTIFACT, OBJECTS_PER_ARTIFACT = 15, 4
"""Steps that a put of few files takes in a file system, and its objects in an object store."""
LATE_SEC = 0.2
"""Longest time between the awaited artifact and the kill, s: masks are written then."""


class Cell(NamedTuple):
    """A kind of kill: a command, its number of worker processes, and which of its processes is killed."""

    command: str
    workers: int
    victim: str

    def __str__(self) -> str:
        return f"{self.command}-{self.workers}-{self.victim}"


CELLS = [
    Cell(command, workers, victim)
    for command in ("eval", "segment")
    for workers, victim in ((2, "client"), (2, "worker"), (2, "both"), (2, "group"), (0, "client"))
]


class Places(NamedTuple):
    """Files of a run: store, report or masks, and the output of its processes."""

    store: str
    out: Path
    logs: Path


class Moment(NamedTuple):
    """The time of a kill: some seconds after so many artifacts are visible; or at this step of a writer."""

    num_artifacts: int
    delay_sec: float
    step: int | None = None

    def __str__(self) -> str:
        return f"{self.num_artifacts} artifacts + {self.delay_sec:.2f} s" if self.step is None else f"step {self.step}"


class Experiment(NamedTuple):
    """The workload, the place of its results (a folder, and optionally an object store), and the random generator.

    With `only_steps` all kills hit steps of writing.
    """

    workload: Workload
    folder: Path
    objects: ObjectServer | None
    rng: random.Random
    only_steps: bool = False

    def places(self, run: str, command: str) -> Places:
        """Return the places of one run."""
        folder = self.folder / run
        base = self.folder if self.objects is None else self.objects.url
        return Places(f"{base}/{run}/store", folder / ("out" if command == "segment" else "json"), folder / "logs")


def kill_in_time(experiment: Experiment, number: int, cell: Cell, num_artifacts: int) -> tuple[Places, Moment, Run]:
    """Kill the victim at a random moment of a run; of another run if that one ended before."""
    attempt = 0
    while True:
        places = experiment.places(f"run{number}-{attempt}", cell.command)
        moment = draw_moment(num_artifacts, cell, experiment)
        if moment.step is None:
            run = Run(command_of(experiment, cell, places), places.logs)
            is_killed = kill_after(run, moment, cell, places, experiment.rng)
        elif experiment.objects is not None:
            experiment.objects.hold_write(moment.step)
            run = Run(command_of(experiment, cell, places), places.logs)
            wait_until(lambda run=run: run.is_over() or experiment.objects.is_holding)
            is_killed = experiment.objects.is_holding and kill_now(run, cell, experiment.rng)
            experiment.objects.release(drop=is_killed)
        else:
            site = experiment.folder / f"site{number}-{attempt}"
            env, token = die_at_step(site, places.store, moment.step, cell.victim, in_worker=cell.workers > 0)
            run = Run(command_of(experiment, cell, places), places.logs, env)
            wait_until(lambda run=run, token=token: run.is_over() or token.exists())
            is_killed = token.exists()
        if is_killed:
            return places, moment, run
        run.wait()
        attempt += 1


def kill_after(run: Run, moment: Moment, cell: Cell, places: Places, rng: random.Random) -> bool:
    """Kill the victim from outside; return False if the run ended before."""
    wait_until(lambda: run.is_over() or has(places.store, moment.num_artifacts))
    time.sleep(moment.delay_sec)
    if cell.victim in ("worker", "both"):
        wait_until(lambda: run.is_over() or bool(run.workers()))
    return not run.is_over() and kill_now(run, cell, rng)


def kill_now(run: Run, cell: Cell, rng: random.Random) -> bool:
    """Kill the victim, a random worker if there are several; return False if there is none yet."""
    workers = run.workers()
    if cell.victim in ("worker", "both") and not workers:
        return False
    run.kill(cell.victim, rng.choice(workers) if workers else None)
    return True


def command_of(experiment: Experiment, cell: Cell, places: Places) -> list[str]:
    """Return the command line of a run, and of the one that resumes it."""
    return experiment.workload.command(cell.command, places.store, places.out, "--workers", str(cell.workers))


def has(store: str, min_artifacts: int) -> bool:
    """Return whether so many artifacts are visible."""
    return min_artifacts == 0 or count_artifacts(store) >= min_artifacts


def draw_moment(num_artifacts: int, cell: Cell, experiment: Experiment) -> Moment:
    """Draw a moment: any time during start-up, any step of writing, or any number of artifacts and a delay."""
    kind = EARLY_SHARE if experiment.only_steps else experiment.rng.random()
    if kind < EARLY_SHARE:
        return Moment(0, experiment.rng.uniform(0.0, EARLY_SEC))
    if kind < EARLY_SHARE + STEP_SHARE:
        if experiment.objects is not None:
            return Moment(0, 0.0, experiment.rng.randint(1, num_artifacts * OBJECTS_PER_ARTIFACT))
        # Each process counts its own steps.
        num_steps = num_artifacts * STEPS_PER_ARTIFACT // max(1, cell.workers)
        return Moment(0, 0.0, experiment.rng.randint(1, num_steps))
    return Moment(experiment.rng.randint(1, num_artifacts), experiment.rng.uniform(0.0, LATE_SEC))
