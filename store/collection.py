"""Mark and sweep: deleting what no run's pin reaches.

The sweep takes no lock. It first takes what it would delete out of service, each artifact at once, then reads the pins
again and gives back what a run has pinned meanwhile, and deletes only then. A run pins before it looks: so either its
pin is seen here, or its lookup already finds the artifact gone and computes it.
"""

import time
from collections.abc import Collection, Iterable, Sequence

from moseg.schemas.errors import CorruptArtifactError
from moseg.store.backend import Backend, ManifestSource
from moseg.store.names import check_ref
from moseg.store.outcomes import GcReport, Pin
from moseg.store.pins import discard_ended, ended_pins, pinned
from moseg.store.reading import check_seal


def collect(backend: Backend, *, is_dry: bool = True, grace_seconds: float = 86_400.0) -> GcReport:
    """Delete the artifacts that no pin reaches and that lie here longer than the grace period, or only say which.

    Pins reach what they name and, through the inputs in manifests, all that it was made from; an input that is not
    stored ends the walk there. Interrupted puts, quarantined artifacts older than the grace period, and pins that hold
    no longer go too.
    """
    now = time.time()
    reached = reachable(pinned(backend).values(), [backend])
    committed = backend.committed()
    doomed = [ref for ref, moment in committed.items() if ref not in reached and moment <= now - grace_seconds]
    leftovers = backend.leftovers(now, now - grace_seconds)
    ended = ended_pins(backend)
    nbytes = sum(backend.nbytes(doomed).values()) + sum(leftovers.values()) + sum(ended.values())
    if not is_dry:
        doomed = _sweep(backend, doomed)
        backend.discard(leftovers)
        discard_ended(backend, ended)
    return GcReport(len(committed) - len(doomed), tuple(doomed), (*leftovers, *ended), nbytes, is_dry)


def remove(backend: Backend, ref: str) -> bool:
    """Delete one artifact; False where there is none. It vanishes whole."""
    check_ref(ref)
    trash = backend.new_trash()
    try:
        trash.take([ref])
    finally:
        trash.empty()
    return ref in trash.taken


def reachable(pins: Iterable[Pin], sources: Sequence[ManifestSource]) -> set[str]:
    """References that the pins name, and the inputs of each whose manifest lies in one of the sources."""
    reached: set[str] = set()
    waiting = {ref for pin in pins for ref in pin.refs}
    while waiting:
        reached |= waiting
        waiting = _inputs(waiting, sources) - reached
    return reached


def _sweep(backend: Backend, doomed: list[str]) -> list[str]:
    trash = backend.new_trash()
    try:
        try:
            trash.take(doomed)
            rescued = reachable(pinned(backend).values(), [backend, trash]) & trash.taken
        except BaseException:
            trash.give_back(list(trash.taken))
            raise
        trash.give_back(rescued)
    finally:
        trash.empty()
    return [ref for ref in doomed if ref in trash.taken]


def _inputs(refs: Collection[str], sources: Sequence[ManifestSource]) -> set[str]:
    """Inputs of all these artifacts; none of one that is not stored or damaged."""
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
