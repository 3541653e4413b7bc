"""A session: one store and one runner, and the work that a command has them do."""

import math
import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeVar

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError, StoreError
from moseg.schemas.events import SubjectEvent
from moseg.schemas.recipes import Recipe, split_ref
from moseg.schemas.scores import StoreUse
from moseg.store import ArtifactStore, PutOutcome
from moseg.workflows.cluster.runners import Call, Runner
from moseg.workflows.engine.execution import execute_batches, execute_ingest, quarantine_corrupt
from moseg.workflows.engine.ingest import IngestJob, recall_ingests
from moseg.workflows.engine.phases import batch_recipes, join_brief, network_of, split_phases
from moseg.workflows.engine.planning import Plan, make_plan
from moseg.workflows.process.progress import PATIENCE_SEC, StageProgress
from moseg.workflows.runlog.events import new_run_id
from moseg.workflows.runlog.run_log import RunLog
from moseg.workflows.stages.registry import find_task
from moseg.workflows.weights.folder import Weights, WeightsLeaf, open_weights, weights_leaf
from moseg.workflows.weights.reading import require_network_packages

MAX_REPAIRS = 1000
"""Corrupt artifacts that one run mends before it gives up: a disk that fails everywhere is not mended so."""
GPU_BATCH = 8
"""Frames that a GPU is given at once unless the user says otherwise: RAFT then takes some 4 GB at 1024x576."""
BRIEF_PER_CALL = 24
"""Flows both ways and saliency of eight frames: a second of work, beside which the scheduler's milliseconds vanish."""
CALLS_PER_WORKER = 8
"""Calls that each worker should get at least, so that all end at about the same time."""
LEASE_SECONDS = 7 * 86_400.0
"""For how long `gc` spares what a run in progress touches, should the run die without a word."""

Result = TypeVar("Result")


class StageUse(NamedTuple):
    """Artifacts of one stage computed and reused by a run, and the seconds spent inside the stage's functions."""

    computed: int
    reused: int
    seconds: float


class Session:
    """Computes what is missing, reuses what exists, repairs what is corrupt, and counts it all.

    Attributes
    ----------
    run_id : str
        Names the session's log, if it computes anything, and its lease on what it works with.
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
    ):
        self.store = store
        self._weights = weights or open_weights(os.environ)
        self._batch = batch
        self.computed: Counter[str] = Counter()
        self.reused: Counter[str] = Counter()
        self._seconds: Counter[str] = Counter()
        self._ingests: set[str] = set()
        self._weights_leaves: dict[str, WeightsLeaf] = {}
        # A name of its own: another process that does the same work must not end this one's lease.
        self.run_id = new_run_id()
        self._log = RunLog(store, self.run_id, quiet)
        self._leased: frozenset[str] = frozenset()
        self._renew_at = math.inf
        self._pins: dict[str, None] = {}
        self._runner = runner
        self._quiet = quiet
        self._started = time.perf_counter()

    @property
    def seconds(self) -> float:
        """Wall time since the session began."""
        return time.perf_counter() - self._started

    def stages(self) -> dict[str, StageUse]:
        """Use of the store by stage, in the order in which the stages first appeared."""
        names = dict.fromkeys([*self.computed, *self.reused])
        return {name: StageUse(self.computed[name], self.reused[name], self._seconds[name]) for name in names}

    def use(self) -> StoreUse:
        """Artifacts computed and reused over all stages."""
        return StoreUse(computed=self.computed.total(), reused=self.reused.total())

    def num_workers(self) -> int:
        """How many calls run at the same time."""
        return self._runner.num_workers()

    def tell(self, line: str) -> None:
        """A line on standard error, unless the session is to be quiet."""
        if not self._quiet:
            print(line, file=sys.stderr, flush=True)

    def describe(self, subject: SubjectEvent) -> None:
        """Have the run's log, if there is to be one, say what the run is about."""
        self._log.describe(subject)

    def has_log(self) -> bool:
        """Whether the run has computed something, so that `run_id` names a log."""
        return self._log.is_open

    def ingest(self, jobs: Sequence[IngestJob]) -> list[dict]:
        """Leaves of every job, decoded now or remembered from the same file bytes."""
        # Their files are hashed.
        with StageProgress({"sources": len(jobs)}, self._quiet, "files hashed", PATIENCE_SEC) as progress:
            recipes = [job.recipe for job in progress.each("sources", jobs)]
        found = recall_ingests(self.store, recipes)
        batches: dict[str, dict[str, tuple[IngestJob, Recipe]]] = {}
        for job, recipe in zip(jobs, recipes, strict=True):
            if found[recipe.ref] is None:
                batches.setdefault(job.batch or recipe.ref, {})[recipe.ref] = (job, recipe)
        calls = [
            Call(
                next(iter(batch)).replace("/", "-"),
                execute_ingest,
                (self.store.url, tuple(batch.values()), self.run_id),
            )
            for batch in batches.values()
        ]
        if calls:
            self._lease(found)
            self._log.open(self._runner.num_workers)
            self._log.plan_ingest([ref for batch in batches.values() for ref in batch])
        with StageProgress({"ingest": sum(len(batch) for batch in batches.values())}, self._quiet) as progress:

            def done(name, remembered):
                found.update(remembered)
                self.computed["ingest"] += len(remembered)
                progress.advance("ingest", len(remembered))

            self._runner.run(calls, done)
        self._ingests.update(found)
        return [found[recipe.ref] for recipe in recipes]

    def name_weights(self, items: Mapping[str, str]) -> dict[str, str]:
        """Leaves of weights items, by name; `items` gives the architecture that each must have."""
        leaves = {name: weights_leaf(self._weights, name, architecture) for name, architecture in items.items()}
        self._weights_leaves |= {leaf.recipe.ref: leaf for leaf in leaves.values()}
        return {name: leaf.recipe.ref for name, leaf in leaves.items()}

    def compute(
        self,
        build: Callable[[], tuple[dict[str, Recipe], Sequence[str]]],
        read: Callable[[], Result],
    ) -> Result:
        """Compute what the sinks of the graph that `build` returns still lack, then return what `read` reads of them.

        Both are called again after an artifact was found corrupt and quarantined: the corrupt one may be a leaf, which
        `build` ingests anew, or a sink. The same holds where another run quarantined it between our look and our use.
        """
        # Of this computation alone, so that a wave's pins hold no earlier wave's.
        self._ingests.clear()
        with self._log.watch():
            return self._compute(build, read)

    def _compute(self, build, read):
        repairs = 0
        missed: set[str] = set()
        while True:
            try:
                recipes, sinks = build()
                plan = self._plan(recipes, sinks)
                self._run(plan)
                result = read()
                self.reused += plan.count()[1]
                self._keep((*sinks, *sorted(self._ingests)), is_new=bool(plan.compute))
                return result
            except CorruptArtifactError as error:
                if repairs == MAX_REPAIRS:
                    raise
                repairs += 1
                self._quarantine(error)
            except MissingArtifactError as error:
                # Missing again after it was planned anew is no other run's doing.
                if str(error) in missed:
                    raise
                missed.add(str(error))

    def close(self) -> None:
        """End the lease on what this session touched; what its finished runs gave stays pinned."""
        try:
            if self._leased:
                self.store.unpin(self.run_id)
                self._leased = frozenset()
        finally:
            self._log.close(tuple(self._pins))

    def _quarantine(self, error: CorruptArtifactError) -> None:
        if quarantine_corrupt(self.store.url, error):
            self._log.open(self._runner.num_workers)
            self._log.quarantined(error)

    def _keep(self, refs: Sequence[str], is_new: bool) -> None:
        """Pin a finished run's results under a name that follows from them.

        Where nothing was computed the store may be one that can only be read, and then nobody collects it from here.
        """
        name = digest_json("run", sorted(refs))[:16]
        if self.store.pin_of(name) is None:
            try:
                self.store.pin(name, refs)
            except StoreError:
                if is_new:
                    raise
                return
        self._pins[name] = None

    def _plan(self, recipes: dict[str, Recipe], sinks: Sequence[str]) -> Plan:
        """A plan whose artifacts are pinned: what `gc` took between the look-up and the pin is planned again.

        Nothing reads what ingest remembers, so it is pinned by name.
        """
        pinned = set(self._ingests)
        while True:
            plan = make_plan(self.store, recipes, sinks)
            if not plan.compute or plan.touched() <= pinned:
                return plan
            pinned |= plan.touched()
            self._lease(pinned)

    def _lease(self, refs: Iterable[str]) -> None:
        """Protect what this session works on, in place of what it worked on before."""
        leased = frozenset(refs)
        self.store.pin(self.run_id, leased, lease_seconds=LEASE_SECONDS)
        self._leased = leased
        self._renew_at = time.monotonic() + LEASE_SECONDS / 2

    def _run(self, plan: Plan) -> None:
        totals, _ = plan.count()
        if plan.compute:
            self._log.open(self._runner.num_workers)
            self._log.plan(plan.compute, plan.reuse)
        self._fetch_weights(plan)
        if plan.compute:
            # Only now: bad input is told in one line.
            self._log.announce()
        with StageProgress(totals, self._quiet) as progress:

            def done(name, reports):
                for report in reports:
                    stage = split_ref(report.ref)[0]
                    count = self.reused if report.outcome == PutOutcome.LOST_RACE else self.computed
                    count[stage] += 1
                    self._seconds[stage] += report.seconds
                    progress.advance(stage)
                if time.monotonic() > self._renew_at:
                    self._lease(self._leased)

            for recipes in split_phases(plan.compute):
                self._runner.run(self._calls(recipes), done)

    def _calls(self, recipes: dict[str, Recipe]) -> Iterator[Call]:
        """Calls that compute the recipes of one phase."""
        batch_size = self._batch or 1
        if self._batch is None and any(network_of(recipe) is not None for recipe in recipes.values()):
            batch_size = GPU_BATCH if self._runner.has_gpu() else 1

        def size(recipe: Recipe) -> int:
            task = find_task(recipe.task, recipe.params["method"])
            return 1 if task.run_together is None else batch_size

        def is_brief(recipe: Recipe) -> bool:
            return find_task(recipe.task, recipe.params["method"]).is_brief

        call_of: dict[str, str] = {}
        # Where there is little to do, no worker is to wait for another's long call.
        share = sum(map(is_brief, recipes.values())) // (CALLS_PER_WORKER * self._runner.num_workers())
        joined = join_brief(batch_recipes(recipes, size), is_brief, min(max(share, 1), BRIEF_PER_CALL))
        for batches in joined:
            name = batches[0][0].ref.replace("/", "-")
            computed = [recipe for batch in batches for recipe in batch]
            parents = dict.fromkeys(
                call_of[parent] for recipe in computed for parent in recipe.input_refs() if parent in call_of
            )
            call_of |= {recipe.ref: name for recipe in computed}
            arguments = (self.store.url, tuple(map(tuple, batches)), self.run_id)
            yield Call(name, execute_batches, arguments, tuple(parents), network_of(computed[0]) is not None)

    def _fetch_weights(self, plan: Plan) -> None:
        """Have the leaves and the files of every network that the plan runs, before any task waits for them."""
        needed = {recipe.inputs["weights"]: None for recipe in plan.compute.values() if network_of(recipe) is not None}
        if needed:
            require_network_packages()
        for leaf in (self._weights_leaves[ref] for ref in needed):
            if not self.store.has(leaf.recipe.ref):
                self.store.put(leaf.recipe, {}, leaf.attributes)
            self._weights.ensure(self._weights.item(leaf.attributes["item"]))
