"""Download of the missing files of a weights item, by one process at a time."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

from filelock import FileLock, Timeout

from moseg.schemas.weights import WeightsFile
from moseg.workflows.process.atomic_write import blame_output
from moseg.workflows.weights.download import Downloaded, Source, download
from moseg.workflows.weights.hub import HubFile, parse_hub_url, read_pointer, resolve_commit, token_for
from moseg.workflows.weights.item_folder import ItemFolder
from moseg.workflows.weights.pins import FilePin, Pins, read_pins, sha256_of, write_pins
from moseg.workflows.weights.progress import DownloadProgress

LOCK = ".lock"


def fetch_item(files: ItemFolder, token: str | None, quiet: bool) -> None:
    """Download the files of an item that are missing; each of them has an address.

    Parameters
    ----------
    token : str or None
        The user's token for the hub.

    Raises
    ------
    InputError
        A file cannot be downloaded, is not what it must be, or cannot be written.
    """
    with _locked(files.path, files.item.name, quiet):
        # Listed under the lock: another process may have fetched them meanwhile.
        for file in files.missing():
            _fetch_file(files, file, token, quiet)


def fetch_again(files: ItemFolder, token: str | None, quiet: bool) -> None:
    """Download again the files that only their first download fixes, and pin what they are now.

    Files that match the hub's record are kept. The branch's commit stays the same.

    Raises as `fetch_item` does; a file that cannot be downloaded is then as it was.
    """
    with _locked(files.path, files.item.name, quiet):
        for file in files.item.files:
            if file.is_fixed_by_download:
                _fetch_file(files, file, token, quiet, again=True)


def _fetch_file(files: ItemFolder, file: WeightsFile, token: str | None, quiet: bool, again: bool = False) -> None:
    """Download one file; pin what is not known of it beforehand."""
    label = f"{files.item.name}/{file.name}"
    pins = read_pins(files.path)
    if again:
        pins = pins.without(file)
    source = Source(file.url, file.sha256, file.size, homepage=files.item.homepage)
    if file.sha256 is None:
        pins, source = _find_pin(file, source, files.path, pins, token, label)
    source = source._replace(token=token_for(source.url, token))
    target = files.path / file.name

    def pin(found: Downloaded) -> None:
        if file.sha256 is None:
            pinned = FilePin(source=file.url, sha256=found.sha256, size=found.size)
            write_pins(files.path, pins.model_copy(update={"files": {**pins.files, file.name: pinned}}))

    if again and source.sha256 is not None and target.is_file() and sha256_of(target) == source.sha256:
        pin(Downloaded(source.sha256, target.stat().st_size))
    else:
        with DownloadProgress(label, urlsplit(source.url).hostname, quiet) as progress:
            download(source, target, progress.advance, record=pin)


def _find_pin(
    file: WeightsFile, source: Source, folder: Path, pins: Pins, token: str | None, label: str
) -> tuple[Pins, Source]:
    """Return what an earlier download or the hub says that a file must be, for an item that does not say it."""
    hub = parse_hub_url(file.url)
    if hub is not None and not hub.is_pinned:
        pins, hub = _pin_commit(hub, folder, pins, token, label)
        source = source._replace(url=hub.url)
    pin = pins.of(file)
    if pin is None and hub is not None:
        pin = read_pointer(hub, token)
    elif pin is None:
        _note(f"no checksum of {label} is published; that of this download is recorded and enforced from now on")
    return pins, source if pin is None else source._replace(sha256=pin.sha256, size=pin.size)


def _pin_commit(hub: HubFile, folder: Path, pins: Pins, token: str | None, label: str) -> tuple[Pins, HubFile]:
    """Return the file at the commit that is recorded for its branch; record the commit if there is none."""
    branch = f"{hub.repository}@{hub.revision}"
    if branch not in pins.commits:
        commit = resolve_commit(hub, token)
        _note(f"no version of {label} is pinned; {branch} is at {commit}, which is recorded and kept from now on")
        pins = pins.model_copy(update={"commits": {**pins.commits, branch: commit}})
        write_pins(folder, pins)
    return pins, hub._replace(revision=pins.commits[branch])


def _note(line: str) -> None:
    """Print a note even if the run is quiet: nothing else warns that the file is not verified."""
    print(f"note: {line}", file=sys.stderr, flush=True)


@contextmanager
def _locked(folder: Path, name: str, quiet: bool) -> Iterator[None]:
    """Create the folder if there is none, and lock it against other processes that fetch into it."""
    lock = FileLock(folder / LOCK)
    with blame_output(folder):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            if not quiet:
                print(f"{name}: waiting for another process that fetches it", file=sys.stderr, flush=True)
            lock.acquire()
    try:
        yield
    finally:
        lock.release()
