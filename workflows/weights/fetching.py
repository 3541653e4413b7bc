"""Fetching what is missing of a weights item, one process at a time."""

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
        A file cannot be had, is not what it must be, or cannot be written.
    """
    with _alone(files.path, files.item.name, quiet):
        # Looked up under the lock: another process may have fetched them meanwhile.
        for file in files.missing():
            _fetch_file(files, file, token, quiet)


def fetch_again(files: ItemFolder, token: str | None, quiet: bool) -> None:
    """Download the files that only their first download vouches for once more, and pin what they are now.

    Those whose record on the hub says that they are right stay as they are. The branch's commit stays the same.

    Raises as `fetch_item` does; a file that cannot be had is then as it was.
    """
    with _alone(files.path, files.item.name, quiet):
        for file in files.item.files:
            if file.is_fixed_by_download:
                _fetch_file(files, file, token, quiet, again=True)


def _fetch_file(files: ItemFolder, file: WeightsFile, token: str | None, quiet: bool, again: bool = False) -> None:
    """Download one file; what is not known of it beforehand is pinned."""
    label = f"{files.item.name}/{file.name}"
    pins = read_pins(files.path)
    if again:
        pins = pins.without(file)
    source = Source(file.url, file.sha256, file.size, homepage=files.item.homepage)
    if file.sha256 is None:
        pins, source = _find_pin(file, source, files.path, pins, token, label)
    source = source._replace(token=token_for(source.url, token))
    target = files.path / file.name
    if again and source.sha256 is not None and target.is_file() and sha256_of(target) == source.sha256:
        found = Downloaded(source.sha256, target.stat().st_size)
    else:
        with DownloadProgress(label, urlsplit(source.url).hostname, quiet) as progress:
            found = download(source, target, progress.advance)
    if file.sha256 is None:
        pin = FilePin(source=file.url, sha256=found.sha256, size=found.size)
        write_pins(files.path, pins.model_copy(update={"files": {**pins.files, file.name: pin}}))


def _find_pin(
    file: WeightsFile, source: Source, folder: Path, pins: Pins, token: str | None, label: str
) -> tuple[Pins, Source]:
    """What a file must be by an earlier download or by the hub, where the item does not say it."""
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
    """The file at the commit that was recorded for its branch; recorded now where none was."""
    branch = f"{hub.repository}@{hub.revision}"
    if branch not in pins.commits:
        commit = resolve_commit(hub, token)
        _note(f"no version of {label} is pinned; {branch} is at {commit}, which is recorded and kept from now on")
        pins = pins.model_copy(update={"commits": {**pins.commits, branch: commit}})
        write_pins(folder, pins)
    return pins, hub._replace(revision=pins.commits[branch])


def _note(line: str) -> None:
    """Said however quiet the run is: nobody vouches for the file."""
    print(f"note: {line}", file=sys.stderr, flush=True)


@contextmanager
def _alone(folder: Path, name: str, quiet: bool) -> Iterator[None]:
    """The folder, made where there is none, while no other process fetches into it."""
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
