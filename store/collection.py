"""Garbage collection by mark and sweep: deleting artifacts that no run's pin reaches.

The sweep takes no lock. It first takes unreachable artifacts out of service, each atomically, then reads the pins again
and restores artifacts that a run has pinned in the meantime, and deletes only then. A run pins before it looks up: so
either the sweep sees the pin, or the run finds the artifact gone and computes it.

A sweep that fails restores what it took. What it could not restore, or what a killed sweep took, is restored by the
next collection, which then judges it as any other artifact.
"""

import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager

from moseg.schemas.errors import CorruptArtifactError
from moseg.store.backend import Backend, ManifestSource, Trash
from moseg.store.names import check_ref
from moseg.store.outcomes import GcReport, Pin
from moseg.store.pins import discard_ended, ended_pins, pinned, unpin
from moseg.store.reading import check_seal

CLOCK_SECONDS = 60.0
"""Difference that the clocks of a run's machine and of an object store may have."""
STEP_SECONDS = 86_400.0
"""Longest time between two leases of a run at work; an older one is taken for that of a run that died elsewhere."""


def collect(
    backend: Backend,
    *,
    is_dry: bool = True,
    grace_seconds: float = 86_400.0,
    forget: Collection[str] = (),
    keep_nbytes: int | None = None,
) -> GcReport:
    """See `ArtifactStore.gc`."""
    now = time.time()
    if not is_dry:
        backend.restore_abandoned(now)
    pins = [pin for name, pin in pinned(backend).items() if name not in forget]
    reached = reachable(pins, [backend])
    # A run at work cannot name the leaves that it decodes before it has decoded them.
    leases = [pin.created for pin in pins if pin.expires is not None and pin.created > now - STEP_SECONDS]
    began = [created - CLOCK_SECONDS for created in leases]
    used = backend.committed()
    latest = min([now - grace_seconds, *began])
    unreachable = [ref for ref, moment in used.items() if ref not in reached and moment <= latest]
    left = None
    if keep_nbytes is None:
        sizes = backend.nbytes(unreachable)
    else:
        sizes = backend.nbytes(used)
        unreachable, left = _oldest_first(unreachable, used, sizes, keep_nbytes)
    leftovers = backend.leftovers(now, now - grace_seconds)
    ended = ended_pins(backend)
    if not is_dry:
        for name in forget:
            unpin(backend, name)
        unreachable = _sweep(backend, unreachable)
        backend.discard(leftovers)
        discard_ended(backend, ended)
    nbytes = sum(sizes[ref] for ref in unreachable) + sum(leftovers.values()) + sum(ended.values())
    return GcReport(len(used) - len(unreachable), tuple(unreachable), (*leftovers, *ended), nbytes, is_dry, left)


def _oldest_first(
    refs: Iterable[str], used: Mapping[str, float], sizes: Mapping[str, int], keep_nbytes: int
) -> tuple[list[str], int]:
    """Return the least recently used artifacts without which the rest takes at most `keep_nbytes`, and its bytes."""
    left = sum(sizes.values())
    taken: list[str] = []
    for ref in sorted(refs, key=lambda ref: (used[ref], ref)):
        if left <= keep_nbytes:
            break
        taken.append(ref)
        left -= sizes[ref]
    return taken, left


def remove(backend: Backend, ref: str) -> bool:
    """See `ArtifactStore.remove`."""
    check_ref(ref)
    trash = backend.new_trash()
    with _restoring(trash):
        trash.take([ref])
    trash.empty()
    return ref in trash.taken


def release(backend: Backend, refs: Iterable[str]) -> int:
    """See `ArtifactStore.release`."""
    stored = backend.present(refs)
    reached = reachable(pinned(backend).values(), [backend])
    return len(_sweep(backend, sorted(stored - reached)))


def reachable(pins: Iterable[Pin], sources: Sequence[ManifestSource]) -> set[str]:
    """Return the references that the pins name, and of pins with inputs, the inputs of each whose manifest is in one of
    the sources."""
    alone: set[str] = set()
    waiting: set[str] = set()
    for pin in pins:
        (waiting if pin.with_inputs else alone).update(pin.refs)
    reached: set[str] = set()
    while waiting:
        reached |= waiting
        waiting = _inputs(waiting, sources) - reached
    return reached | alone


def _sweep(backend: Backend, unreachable: list[str]) -> list[str]:
    trash = backend.new_trash()
    with _restoring(trash):
        trash.take(unreachable)
        rescued = reachable(pinned(backend).values(), [backend, trash]) & trash.taken
    trash.restore(rescued)
    trash.empty()
    return [ref for ref in unreachable if ref in trash.taken]


@contextmanager
def _restoring(trash: Trash) -> Iterator[None]:
    """Restore everything that was taken if the block fails.

    The trash is not emptied then: what cannot be restored now is restored by a collection after this process has ended.
    """
    try:
        yield
    except BaseException:
        trash.restore(list(trash.taken))
        raise


def _inputs(refs: Collection[str], sources: Sequence[ManifestSource]) -> set[str]:
    """Return the inputs of all these artifacts; none of one that is missing or damaged."""
    found: set[str] = set()
    for source in sources:
        manifests = source.read_manifests(refs)
        for ref, data in manifests.items():
            try:
                found.update(check_seal(ref, data).manifest.recipe.input_refs())
            except CorruptArtifactError:
                continue
        refs = [ref for ref in refs if ref not in manifests]
    return found
