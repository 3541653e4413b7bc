"""A session: one store and one runner, and the work that a command has them do."""

import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing, contextmanager, nullcontext
from typing import NamedTuple, TypeVar

from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, StoreError
from moseg.schemas.recipes import Recipe, split_ref
from moseg.schemas.scores import StoreUse
from moseg.store import ArtifactStore, PutOutcome, map_reads, open_store
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.runners import Runner, open_runner
from moseg.workflows.cluster.tls_files import TlsFiles
from moseg.workflows.engine.calls import make_calls, make_ingest_calls
from moseg.workflows.engine.cues import split_cues
from moseg.workflows.engine.ingest import IngestJob, recall_ingests
from moseg.workflows.engine.phases import network_of, split_phases
from moseg.workflows.engine.planning import Plan, make_plan
from moseg.workflows.engine.run_pins import RunPins
from moseg.workflows.engine.space import check_space, plan_nbytes
from moseg.workflows.process.amounts import read_size, size
from moseg.workflows.process.progress import PATIENCE_SEC, StageProgress
from moseg.workflows.runlog.events import new_run_id
from moseg.workflows.runlog.run_log import RunLog
from moseg.workflows.weights.folder import Weights, WeightsLeaf, find_item, open_weights, weights_leaf
from moseg.workflows.weights.leaves_by_name import LeavesByName
from moseg.workflows.weights.reading import require_network_packages

BUDGET_VARIABLE = "MOSEG_STORE_SIZE"
"""Variable of the environment with the size that the user allows a store, such as ``20G``."""
GRACE_SECONDS = 600.0
"""Time since their last use for which artifacts are spared when a session makes room."""
MAX_REPAIRS = 1000
"""Corrupt artifacts that one run repairs before it gives up: a disk that fails everywhere cannot be repaired so."""

Result = TypeVar("Result")


@contextmanager
def open_session(
    store: str,
    workers: int = 0,
    scheduler: str | None = None,
    tls: TlsFiles | None = None,
    quiet: bool = False,
    device: str = "auto",
    threads: int = 1,
    batch: int | None = None,
    offline: bool = False,
    non_commercial: bool = False,
    accept_licence: str | None = None,
    keep_cues: bool = True,
) -> "Iterator[Session]":
    """Open a session on the store at `store`, which is created if there is none; the runner ends with the block.

    See `Session` about `keep_cues`.

    Raises
    ------
    InputError
        The store, the workers or the device are not available, or the size of a batch is out of range.
    """
    if batch is not None and batch < 1:
        raise InputError("not a number of frames", where="--batch", got=batch, expected="1 or more")
    budget = os.environ.get(BUDGET_VARIABLE)
    max_nbytes = read_size(budget, BUDGET_VARIABLE) if budget else None
    weights = open_weights(
        os.environ,
        offline=offline,
        allow_non_commercial=non_commercial,
        quiet=quiet,
        accept_licence=accept_licence,
    )
    # A run that nothing can compute leaves no new store behind.
    with open_runner(workers, scheduler, device, threads, tls) as runner:
        opened = open_store(store, create=True)
        with closing(Session(opened, runner, quiet, weights, batch, keep_cues, max_nbytes)) as session:
            yield session


class StageUse(NamedTuple):
    """Artifacts of one stage computed and reused by a run, and the seconds spent inside the stage's functions."""

    computed: int
    reused: int
    seconds: float


class Session:
    """A run: it computes missing artifacts, reuses stored ones, repairs corrupt ones, and counts all.

    Parameters
    ----------
    keep_cues : bool
        Whether dense maps that can be computed again stay in the store after the results are read (see `Task.is_cue`).
    max_nbytes : int, optional
        Bytes to which the store is reduced at the end of a session that computed something: the least recently used
        artifacts go first, and nothing that a run keeps or works with.

    Attributes
    ----------
    store : ArtifactStore
    runner : Runner
    run_id : str
        Name of the run's log, if it computes anything, and of its lease on what it works with.
    log : RunLog
    computed, reused : Counter by stage
        Artifacts written by this session, and stored artifacts that its plans built on.
    """

    def __init__(
        self,
        store: ArtifactStore,
        runner: Runner,
        quiet: bool = False,
        weights: Weights | None = None,
        batch: int | None = None,
        keep_cues: bool = True,
        max_nbytes: int | None = None,
    ):
        self.store = store
        self.runner = runner
        # A name of its own: another process that does the same work must not end this one's lease.
        self.run_id = new_run_id()
        self.log = RunLog(store, self.run_id, quiet)
        self.computed: Counter[str] = Counter()
        self.reused: Counter[str] = Counter()
        self._seconds: Counter[str] = Counter()
        self._started = time.perf_counter()
        self._pins = RunPins(store, self.run_id)
        # What `build` reads in the store before it can return the graph: memories of ingest, settled artifacts.
        self._first: set[str] = set()
        self._settled: dict[str, Recipe] = {}
        self._settled_hits: dict[str, None] = {}
        self._settled_now: set[str] = set()
        self._weights = weights or open_weights(os.environ)
        self._weights_leaves: dict[str, WeightsLeaf] = {}
        self._batch = batch
        self._keep_cues = keep_cues
        self._max_nbytes = max_nbytes
        self._quiet = quiet

    @property
    def keeps_cues(self) -> bool:
        """Whether cues stay in the store after the results are read."""
        return self._keep_cues

    @property
    def seconds(self) -> float:
        """Wall time since the session began."""
        return time.perf_counter() - self._started

    def stages(self) -> dict[str, StageUse]:
        """Return the use of the store by stage, in the order in which the stages first appeared."""
        names = dict.fromkeys([*self.computed, *self.reused])
        return {name: StageUse(self.computed[name], self.reused[name], self._seconds[name]) for name in names}

    def use(self) -> StoreUse:
        """Return the numbers of artifacts computed and reused over all stages."""
        return StoreUse(computed=self.computed.total(), reused=self.reused.total())

    def report(self, line: str) -> None:
        """Print a line on standard error, unless the session is quiet."""
        if not self._quiet:
            print(line, file=sys.stderr, flush=True)

    def ingest(
        self, jobs: Sequence[IngestJob], estimate: Callable[[Sequence[int]], float] = lambda places: 0.0
    ) -> list[dict]:
        """Return the leaves of every job, decoded now or remembered from the same file bytes.

        `estimate` returns about how many bytes the sources of the jobs in these places, which have to be decoded, and
        what is computed from them take.
        """
        # Each job's recipe is a digest of its files.
        with StageProgress({"sources": len(jobs)}, self._quiet, "files hashed", PATIENCE_SEC) as progress:
            recipes = [job.recipe for job in progress.each("sources", jobs)]
        found = recall_ingests(self.store, recipes)
        needed = zip(jobs, recipes, strict=True)
        missing = {recipe.ref: (job, recipe) for job, recipe in needed if found[recipe.ref] is None}
        calls: list[Call] = []
        if missing:
            places = [place for place, recipe in enumerate(recipes) if recipe.ref in missing]
            check_space(self.store, estimate(places), self.report)
            self._pins.lease(found)
            self.log.open(self.runner.num_workers)
            self.log.plan(missing)
            calls = list(make_ingest_calls(missing, self.runner, self.store.url, self.run_id))
        with StageProgress({"ingest": len(missing)}, self._quiet) as progress:

            def done(name, remembered):
                found.update(remembered)
                self.computed["ingest"] += len(remembered)
                progress.advance("ingest", len(remembered))

            self.runner.run(calls, done)
        self._first.update(found)
        return [found[recipe.ref] for recipe in recipes]

    def name_weights(self, items: Mapping[str, str]) -> LeavesByName:
        """Return the leaves of weights items, by name; `items` gives the architecture that each must have.

        InputError is raised at once if there is no such item, or if its licence was not accepted; if its files cannot
        be had, when a graph reads the leaf.
        """
        for name, architecture in items.items():
            self._weights.check_licence(find_item(self._weights, name, architecture))
        return LeavesByName(items, self._name_leaf)

    def _name_leaf(self, name: str, architecture: str) -> str:
        leaf = weights_leaf(self._weights, name, architecture)
        self._weights_leaves[leaf.recipe.ref] = leaf
        return leaf.recipe.ref

    def compute(
        self,
        build: Callable[[], tuple[Mapping[str, Recipe], Sequence[str]]],
        read: Callable[[], Result],
        keeps: bool = True,
        restated: AbstractContextManager | None = None,
    ) -> Result:
        """Compute the missing sinks of the graph that `build` returns, then return what `read` returns.

        `build` may ingest sources, and settle a few artifacts that decide what the graph is. Both are called again
        after an artifact was found corrupt and quarantined: the corrupt one may be a leaf, which `build` ingests anew,
        a settled one, or a sink. The same holds if another run quarantined it between the look-up and the read. The
        sinks are pinned as results unless `keeps` is false: a trial among many, which may be collected once it is read.
        `restated` is entered around the work and may raise its error in other words, with which the run's log ends too.
        """
        # Only those of this computation, so that a wave's pins hold no earlier wave's.
        self._first.clear()
        self._settled.clear()
        self._settled_now.clear()
        num_repairs = 0
        missed: set[str] = set()
        with self.log.watch(), restated or nullcontext():
            while True:
                self._settled_hits.clear()
                try:
                    recipes, sinks = build()
                    plan = self._plan(recipes, sinks)
                    self._run(plan)
                    result = read()
                    # What was settled counts once, although the plan finds it in the store.
                    known = self._settled_now.union(self._settled_hits)
                    hits = (*self._settled_hits, *(ref for ref in plan.reuse if ref not in known))
                    self.reused += Counter(split_ref(ref)[0] for ref in hits)
                    self.store.touch(plan.reuse)
                    if keeps:
                        self._finish({**self._settled, **recipes}, (*sinks, *sorted(self._first)), bool(plan.compute))
                    return result
                except CorruptArtifactError as error:
                    if num_repairs == MAX_REPAIRS:
                        raise
                    num_repairs += 1
                    # Opened anew, so that a store that has vanished is reported as such.
                    if open_store(self.store.url, create=False).quarantine(error.ref, str(error)):
                        self.log.open(self.runner.num_workers)
                        self.log.quarantined(error)
                except MissingArtifactError as error:
                    # If it is missing again after it was planned anew, no other run is the reason.
                    if str(error) in missed:
                        raise
                    missed.add(str(error))

    def _finish(self, recipes: Mapping[str, Recipe], refs: Sequence[str], is_new: bool) -> None:
        """Pin results, and let go of the cues that they were computed from unless cues are kept."""
        if self._keep_cues:
            self._pins.keep(refs, is_new)
            return
        kept, cues = split_cues(recipes, refs)
        self._pins.keep(kept, is_new, with_inputs=False)
        if self.computed:
            # Cues of an interrupted run too, whose work this one continued.
            self._pins.end_lease()
            with self._reported("cues stay in the store"):
                self.store.release(cues)

    def settle(self, recipes: Mapping[str, Recipe], sinks: Sequence[str], leaves: Iterable[str] = ()) -> list[dict]:
        """Compute missing artifacts on which the graph itself depends, and return the attributes of each.

        To be called by the `build` of `compute`, which repairs a damaged one.

        Parameters
        ----------
        recipes : mapping of reference to recipe
            Of the sinks, and of all that they are made from but leaves.
        sinks : sequence of references
        leaves : iterable of references
            What the rest of the graph will read: pinned meanwhile.
        """
        plan = self._plan(recipes, sinks, leaves)
        self._run(plan)
        self._settled |= recipes
        self._settled_hits |= dict.fromkeys(plan.reuse)
        self._settled_now.update(plan.compute)
        self._first.update(sinks)
        return list(map_reads(self.store, self.store.attributes, sinks))

    def close(self) -> None:
        """End the lease on what this session worked on; the results of its finished work stay pinned."""
        try:
            self._pins.end_lease()
            self._make_room()
        finally:
            self.log.close(tuple(self._pins.results))

    def _make_room(self) -> None:
        """Reduce the store to the size that the user allows it."""
        if self._max_nbytes is None or not self.computed:
            return
        with self._reported(f"{BUDGET_VARIABLE}: nothing is removed"):
            # Another run may be about to pin what it has just put.
            done = self.store.gc(is_dry=False, grace_seconds=GRACE_SECONDS, keep_nbytes=self._max_nbytes)
            if done.removed:
                number, freed = len(done.removed), size(done.nbytes)
                self.report(f"{BUDGET_VARIABLE}: {number} least recently used artifacts removed ({freed})")

    @contextmanager
    def _reported(self, outcome: str) -> Iterator[None]:
        """Report a store's error in the block instead of raising it: the results are there, and only space is not."""
        try:
            yield
        except StoreError as error:
            self.report(f"{outcome}: {error}")

    def _plan(self, recipes: Mapping[str, Recipe], sinks: Sequence[str], leaves: Iterable[str] = ()) -> Plan:
        """Return a plan whose artifacts are pinned: what `gc` took between the look-up and the pin is planned again.

        No recipe reads what `build` read first, so it is pinned by name.
        """
        pinned = {*self._first, *leaves}
        while True:
            plan = make_plan(self.store, recipes, sinks)
            if not plan.compute or plan.touched() <= pinned:
                return plan
            pinned |= plan.touched()
            self._pins.lease(pinned)

    def _run(self, plan: Plan) -> None:
        """Compute a plan, phase by phase, and count what it computes."""
        if plan.compute:
            check_space(self.store, plan_nbytes(self.store, plan.compute), lambda line: None)
            self.log.open(self.runner.num_workers)
            self.log.plan(plan.compute, (*self._settled_hits, *plan.reuse))
        self._fetch_weights(plan)
        if plan.compute:
            # Not before: bad input is reported in one line.
            self.log.announce()
        with StageProgress(plan.count()[0], self._quiet) as progress:

            def done(name, reports):
                for report in reports:
                    stage = split_ref(report.ref)[0]
                    count = self.reused if report.outcome == PutOutcome.LOST_RACE else self.computed
                    count[stage] += 1
                    self._seconds[stage] += report.seconds
                    progress.advance(stage)
                self._pins.renew()

            for recipes in split_phases(plan.compute):
                calls = make_calls(recipes, self.runner, self.store.url, self.run_id, self._batch)
                self.runner.run(calls, done)

    def _fetch_weights(self, plan: Plan) -> None:
        """Provide the leaves and the files of every network that the plan runs, before any task waits for them."""
        needed = {recipe.inputs["weights"]: None for recipe in plan.compute.values() if network_of(recipe) is not None}
        if needed:
            require_network_packages()
        for leaf in (self._weights_leaves[ref] for ref in needed):
            if not self.store.has(leaf.recipe.ref):
                self.store.put(leaf.recipe, {}, leaf.attributes)
            self._weights.ensure(self._weights.item(leaf.attributes["item"]))
