"""Counts of a run's events: by stage, by artifact and by process."""

from collections import Counter
from datetime import datetime

from moseg.schemas.events import DegenerateEvent, EventKind, PlanEvent, TroubleEvent, WorkEvent
from moseg.schemas.frozen import Frozen

INGEST = "ingest"
"""Stage of the recipes that remember what sources decode to."""


class StageStatus(Frozen):
    """Artifacts of one stage.

    Attributes
    ----------
    planned, done : int
        Artifacts to compute, and those of them that are stored by now, by any process.
    hits : int
        Artifacts stored before, and read or requested by the run.
    computed, committed, lost_races, failed : int
        Events of each kind.
    degenerate, invalid_fits, fits : int
        Artifacts with invalid fits, their invalid fits, and all their fits.
    reasons : dict of str to int
        Why fits are not valid, if the stage gives reasons.
    seconds : float
        Inside the stage's functions.
    """

    stage: str
    planned: int = 0
    done: int = 0
    hits: int = 0
    computed: int = 0
    committed: int = 0
    lost_races: int = 0
    failed: int = 0
    degenerate: int = 0
    invalid_fits: int = 0
    fits: int = 0
    reasons: dict[str, int] = {}
    seconds: float = 0.0


class InFlight(Frozen):
    """Work of a process: the artifact that it computes, since when, and how many it takes after that."""

    host: str
    pid: int
    ref: str
    since: datetime
    num_behind: int


class Trouble(Frozen):
    """A failure or damage, and its artifact if there is one."""

    time: datetime
    ref: str | None
    message: str


class RunCounts:
    """Counts of the events of a run, which are added in the order of their times."""

    def __init__(self):
        self.failures: list[Trouble] = []
        self.quarantined: list[Trouble] = []
        self._counts: Counter[tuple[str, str]] = Counter()
        self._reasons: dict[str, Counter[str]] = {}
        self._seconds: Counter[str] = Counter()
        self._planned: dict[str, None] = {}
        self._done: set[str] = set()
        self._hits: set[str] = set()
        self._started: dict[str, WorkEvent] = {}
        self._last_end: dict[tuple[str, int], datetime] = {}
        self._work_began: datetime | None = None

    def add(self, event: PlanEvent | WorkEvent | DegenerateEvent | TroubleEvent) -> None:
        """Count one more event."""
        match event.event:
            case EventKind.PLANNED:
                self._planned[event.ref] = None
            case EventKind.HIT:
                self._hits.add(event.ref)
            case EventKind.STARTED:
                self._work_began = self._work_began or event.time
                self._started[event.ref] = event
            case EventKind.COMPUTED:
                self._counts[event.stage, "computed"] += 1
                self._seconds[event.stage] += event.seconds or 0.0
            case EventKind.COMMITTED:
                self._end(event, "committed", is_done=True)
            case EventKind.LOST_RACE:
                self._end(event, "lost_races", is_done=True)
            case EventKind.DEGENERATE:
                self._counts.update(
                    {
                        (event.stage, "degenerate"): 1,
                        (event.stage, "invalid_fits"): event.num_invalid,
                        (event.stage, "fits"): event.num_fits,
                    }
                )
                self._reasons.setdefault(event.stage, Counter()).update(event.reasons)
            case EventKind.FAILED:
                self.failures.append(Trouble(time=event.time, ref=event.ref, message=event.message))
                if event.ref is not None:
                    self._end(event, "failed", is_done=False)
            case EventKind.QUARANTINED:
                self.quarantined.append(Trouble(time=event.time, ref=event.ref, message=event.message))
                self._done.discard(event.ref)

    def num_planned(self) -> int:
        """Return the number of artifacts to compute."""
        return len(self._planned)

    def num_done(self) -> int:
        """Return how many of them are stored."""
        # In any order: if clocks differ, an artifact seems to be stored before it was planned.
        return len(self._done & self._planned.keys())

    def stages(self) -> tuple[StageStatus, ...]:
        """Return counts by stage: first stages with something to compute, as planned, then those only read."""
        planned = Counter(map(_stage, self._planned))
        done = Counter(map(_stage, self._done & self._planned.keys()))
        # An artifact that the run itself computed is no hit, though a later plan of the run finds it stored.
        hits = Counter(_stage(ref) for ref in sorted(self._hits - self._planned.keys()))
        names = dict.fromkeys([*planned, *hits, *(stage for stage, _ in self._counts)])
        return tuple(
            StageStatus(
                stage=name,
                planned=planned[name],
                done=done[name],
                hits=hits[name],
                seconds=self._seconds[name],
                reasons=dict(self._reasons.get(name, {})),
                **{count: number for (stage, count), number in self._counts.items() if stage == name},
            )
            for name in names
        )

    def in_flight(self) -> tuple[InFlight, ...]:
        """Return what each process is computing, by host and process."""
        by_process: dict[tuple[str, int], list[WorkEvent]] = {}
        for event in self._started.values():
            by_process.setdefault((event.host, event.pid), []).append(event)
        found = []
        for (host, pid), events in sorted(by_process.items()):
            first = events[0]
            since = max(first.time, self._last_end.get((host, pid), first.time))
            found.append(InFlight(host=host, pid=pid, ref=first.ref, since=since, num_behind=len(events) - 1))
        return tuple(found)

    def rest_seconds(self, now: datetime) -> float | None:
        """Estimate the remaining seconds from each stage's mean time and the pace of the workers so far.

        None while the sources are decoded: the rest is planned after that.
        """
        done = self._seconds.total()
        if self._work_began is None or not done or {_stage(ref) for ref in self._planned} <= {INGEST}:
            return None
        mean = done / sum(number for (_, count), number in self._counts.items() if count == "computed")
        left = Counter(_stage(ref) for ref in self._planned if ref not in self._done)
        rest = 0.0
        for stage, number in left.items():
            computed = self._counts[stage, "computed"]
            rest += number * (self._seconds[stage] / computed if computed else mean)
        return rest * (now - self._work_began).total_seconds() / done

    def _end(self, event: WorkEvent | TroubleEvent, count: str, is_done: bool) -> None:
        self._counts[event.stage, count] += 1
        self._started.pop(event.ref, None)
        self._last_end[event.host, event.pid] = event.time
        if is_done:
            self._done.add(event.ref)
        else:
            self._done.discard(event.ref)


def _stage(ref: str) -> str:
    return ref.partition("/")[0]
