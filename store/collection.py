"""Mark and sweep: deleting what no run's pin reaches.

The sweep takes no lock. It first moves what it would delete aside, each artifact by one rename, then reads the pins
again and moves back what a run has pinned meanwhile, and deletes only then. A run pins before it looks: so either its
pin is seen here, or its lookup already finds the artifact gone and computes it.
"""

import os
import shutil
import time
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime
from pathlib import Path

from schemas.errors import CorruptArtifactError, MissingArtifactError, StoreError
from store.commit import new_staging, staging_owner
from store.layout import Layout
from store.outcomes import GcReport, Pin
from store.owners import is_running
from store.pins import pinned
from store.reading import read_manifest

STAGING_SECONDS = 86_400.0
"""Age at which staging is a leftover whoever owns it: no put takes a day."""


def collect(layout: Layout, *, is_dry: bool = True, grace_seconds: float = 86_400.0) -> GcReport:
    """Delete the artifacts that no pin reaches and that are older than the grace period; by default only say which.

    Pins reach what they name and, through the inputs in manifests, all that it was made from; an input that is not
    stored ends the walk there. Interrupted puts and quarantined artifacts older than the grace period go too.
    """
    now = time.time()
    reached = reachable(pinned(layout).values(), [layout])
    stored = list(layout.refs())
    doomed = [ref for ref in stored if ref not in reached and _created(layout, ref) <= now - grace_seconds]
    leftovers = [*_dead_staging(layout, now), *_old_quarantine(layout, now - grace_seconds)]
    nbytes = sum(folder_nbytes(layout.folder(ref)) for ref in doomed) + sum(map(folder_nbytes, map(str, leftovers)))
    if not is_dry:
        try:
            doomed = _sweep(layout, doomed)
            for folder in leftovers:
                shutil.rmtree(folder, ignore_errors=True)
        except OSError as error:
            raise StoreError(f"cannot collect garbage: {error.strerror}", where=layout.root) from error
    names = tuple(folder.relative_to(layout.root).as_posix() for folder in leftovers)
    return GcReport(len(stored) - len(doomed), tuple(doomed), names, nbytes, is_dry)


def remove(layout: Layout, ref: str) -> bool:
    """Delete one artifact; False where there is none. It vanishes whole, by one rename."""
    try:
        trash = Layout(Path(new_staging(layout)))
        try:
            return _rename(layout.folder(ref), trash.folder(ref))
        finally:
            shutil.rmtree(trash.root, ignore_errors=True)
    except OSError as error:
        raise StoreError(f"cannot remove an artifact: {error.strerror}", where=layout.root, got=ref) from error


def reachable(pins: Iterable[Pin], layouts: Sequence[Layout]) -> set[str]:
    """References that the pins name, and the inputs of each that lies in one of the layouts."""
    reached: set[str] = set()
    waiting = [ref for pin in pins for ref in pin.refs]
    while waiting:
        ref = waiting.pop()
        if ref not in reached:
            reached.add(ref)
            waiting.extend(_inputs(ref, layouts))
    return reached


def folder_nbytes(folder: str) -> int:
    """Bytes of all files under a folder; nothing where it has vanished."""
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(f"{parent}/{name}").st_size
            except FileNotFoundError:
                continue
    return total


def _sweep(layout: Layout, doomed: list[str]) -> list[str]:
    trash = Layout(Path(new_staging(layout)))
    try:
        for ref in doomed:
            _rename(layout.folder(ref), trash.folder(ref))
        rescued = reachable(pinned(layout).values(), [layout, trash]).intersection(doomed)
        for ref in rescued:
            _rename(trash.folder(ref), layout.folder(ref))
    finally:
        shutil.rmtree(trash.root, ignore_errors=True)
    return [ref for ref in doomed if ref not in rescued]


def _rename(source: str, target: str) -> bool:
    os.makedirs(os.path.dirname(target), exist_ok=True)
    try:
        os.rename(source, target)
    except OSError:
        # gone already, or computed again meanwhile
        if os.path.lexists(source) and not os.path.lexists(target):
            raise
        return False
    return True


def _inputs(ref: str, layouts: Sequence[Layout]) -> tuple[str, ...]:
    for layout in layouts:
        try:
            return read_manifest(layout, ref).recipe.input_refs()
        except MissingArtifactError:
            continue
        except CorruptArtifactError:
            break
    return ()


def _created(layout: Layout, ref: str) -> float:
    """Seconds since the epoch; minus infinity for an artifact that is gone meanwhile."""
    try:
        return datetime.fromisoformat(read_manifest(layout, ref).created).timestamp()
    except MissingArtifactError:
        return float("-inf")
    except CorruptArtifactError:
        return _modified(Path(layout.folder(ref)))


def _dead_staging(layout: Layout, now: float) -> Iterator[Path]:
    for folder in _folders(layout.staging):
        owner = staging_owner(folder)
        is_dead = owner is not None and is_running(*owner) is False
        if is_dead or _modified(folder) < now - STAGING_SECONDS:
            yield folder


def _old_quarantine(layout: Layout, before: float) -> Iterator[Path]:
    return (folder for folder in _folders(layout.quarantine) if _modified(folder) <= before)


def _folders(parent: Path) -> list[Path]:
    return sorted(parent.iterdir()) if parent.is_dir() else []


def _modified(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return float("-inf")
