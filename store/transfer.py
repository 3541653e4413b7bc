"""Copying finished artifacts from one store to another.

Every byte is compared with its manifest before the artifact is committed to the target. Artifacts that the target has
are not copied again, so an interrupted transfer continues when it is repeated. Inputs are copied before the artifacts
that were computed from them, so the target's lineage is complete wherever a transfer stops. Only an input that is
damaged at the source is not copied: its descendants are complete without it, as after its removal.
"""

import os
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from graphlib import TopologicalSorter
from typing import NamedTuple

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.store.lineage import Relative, State, ancestry, read_recipes
from moseg.store.local import LocalStore
from moseg.store.outcomes import Pin, PutOutcome
from moseg.store.protocol import ArtifactStore

NUM_THREADS = 16
"""Artifacts copied at a time if one store is behind a network, each whole in memory: some MB to some 10 MB.

Between two disks one thread is fastest: the work is checking and decoding, and threads share the interpreter."""
LEASE_SECONDS = 7 * 86_400.0
"""For how long `gc` at the target keeps the artifacts of a transfer that was killed on another machine.

On the transfer's own machine they are kept until its process ends."""


class TransferPlan(NamedTuple):
    """The artifacts that a transfer has to copy.

    Attributes
    ----------
    selected : tuple of str
        All artifacts that the target shall have, including those that it has already.
    inputs : dict
        Each artifact to copy, and its inputs.
    nbytes : dict
        Bytes of each artifact to copy.
    problems : dict
        Artifacts that cannot be copied because their manifest is damaged, each with the problem.
    """

    selected: tuple[str, ...]
    inputs: dict[str, tuple[str, ...]]
    nbytes: dict[str, int]
    problems: dict[str, str]

    @property
    def num_present(self) -> int:
        """Number of artifacts that the target has already."""
        return len(self.selected) - len(self.inputs) - len(self.problems)


class TransferReport(NamedTuple):
    """Result of a transfer; `problems` names the artifacts that were not copied, each with the problem."""

    num_copied: int
    num_present: int
    nbytes: int
    problems: dict[str, str]


def select(
    source: ArtifactStore, roots: Iterable[str] | None = None, with_inputs: bool = True
) -> dict[str, Relative | None]:
    """Select all artifacts of a store, or the stored ones of the `roots` and, with inputs, of their ancestors.

    Returns each with the data of its manifest if it had to be read, else with None.
    """
    if roots is None:
        return dict.fromkeys(source.refs())
    found = ancestry(source, roots) if with_inputs else read_recipes(source, dict.fromkeys(roots))
    return {relative.ref: relative for relative in found if relative.state != State.ABSENT}


def plan_transfer(
    source: ArtifactStore, target: ArtifactStore | None, selected: Mapping[str, Relative | None]
) -> TransferPlan:
    """Find which of the selected artifacts are missing from the target; from a target of None all are."""
    present = set() if target is None else target.present(selected)
    plan = TransferPlan(tuple(selected), {}, {}, {})
    missing = [ref for ref in selected if ref not in present]
    unread = read_recipes(source, [ref for ref in missing if selected[ref] is None])
    for ref in missing:
        found = selected[ref] or next(unread)
        if found.recipe is None:
            plan.problems[ref] = found.problem
        else:
            plan.inputs[ref] = found.input_refs()
            plan.nbytes[ref] = found.nbytes
    return plan


def transfer(
    source: ArtifactStore,
    target: ArtifactStore,
    plan: TransferPlan,
    on_done: Callable[[str], None] = lambda ref: None,
    num_threads: int | None = None,
) -> TransferReport:
    """Copy the artifacts of a plan, several at a time, inputs first; `on_done` is called after each.

    Raises
    ------
    StoreError
        The target cannot be written, or a store cannot be reached. Artifacts copied until then stay.
    """
    if num_threads is None:
        is_local = isinstance(source, LocalStore) and isinstance(target, LocalStore)
        num_threads = 1 if is_local else NUM_THREADS
    problems = dict(plan.problems)
    copied: list[str] = []

    def copy(ref: str) -> PutOutcome | str:
        try:
            artifact = source.export_artifact(ref)
        except (CorruptArtifactError, MissingArtifactError) as error:
            return str(error)
        return target.import_artifact(artifact)

    for ref, outcome in _run_in_order(plan.inputs, copy, num_threads):
        if isinstance(outcome, PutOutcome):
            if outcome == PutOutcome.COMMITTED:
                copied.append(ref)
        else:
            problems[ref] = outcome
        on_done(ref)
    nbytes = sum(plan.nbytes[ref] for ref in copied)
    num_present = len(plan.selected) - len(copied) - len(problems)
    return TransferReport(len(copied), num_present, nbytes, problems)


@contextmanager
def kept_meanwhile(target: ArtifactStore, refs: Iterable[str]) -> Iterator[None]:
    """Protect artifacts from `gc` at the target while they are copied: no run's pin there reaches them yet."""
    lease = f"copy-{uuid.uuid4().hex}"
    target.pin(lease, refs, lease_seconds=LEASE_SECONDS)
    try:
        yield
    finally:
        target.unpin(lease)


def keep(target: ArtifactStore, pins: Mapping[str, Iterable[str]], origins: Mapping[str, Pin] | None = None) -> None:
    """Pin the copied artifacts, by name of the pin; one that is there keeps its references and what it protects too.

    `origins` are the pins of these names at the source, whose runs and scope are kept.
    """
    there = target.pinned()
    for run_id, refs in pins.items():
        origin, before = (origins or {}).get(run_id), there.get(run_id)
        run = origin.run if origin else ""
        with_inputs = origin.with_inputs if origin else True
        if before is None:
            target.pin(run_id, tuple(dict.fromkeys(refs)), run=run, with_inputs=with_inputs)
            continue
        wanted = tuple(dict.fromkeys([*before.refs, *refs]))
        with_inputs = with_inputs or before.with_inputs
        if (wanted, with_inputs) != (before.refs, before.with_inputs) or before.expires is not None:
            target.pin(run_id, wanted, run=run or before.run, with_inputs=with_inputs)


def is_same_store(one: ArtifactStore, other: ArtifactStore) -> bool:
    """Return whether two stores are the same, also if a folder is reached by two paths."""
    if isinstance(one, LocalStore) and isinstance(other, LocalStore):
        return os.path.samefile(one.root, other.root)
    return one.url == other.url


def _run_in_order(
    inputs: Mapping[str, Sequence[str]], copy: Callable[[str], PutOutcome | str], num_threads: int
) -> Iterator[tuple[str, PutOutcome | str]]:
    """Iterate over artifacts and the results of their copies; a copy starts after the copies of all its inputs."""
    order = TopologicalSorter({ref: [each for each in needed if each in inputs] for ref, needed in inputs.items()})
    order.prepare()
    ready: deque[str] = deque()
    running: dict[Future[PutOutcome | str], str] = {}
    pool = ThreadPoolExecutor(num_threads, thread_name_prefix="moseg-transfer")
    try:
        while order.is_active():
            ready.extend(order.get_ready())
            while ready and len(running) < 2 * num_threads:
                ref = ready.popleft()
                running[pool.submit(copy, ref)] = ref
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                ref = running.pop(future)
                yield ref, future.result()
                order.done(ref)
    finally:
        pool.shutdown(cancel_futures=True)
