"""Requests to an object store, several at a time, by names relative to the store's root."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import AbstractContextManager
from functools import cache, cached_property, lru_cache
from typing import NamedTuple, TypeVar

import obstore
from obstore.exceptions import AlreadyExistsError, BaseError, NotSupportedError
from obstore.store import ObjectStore

from moseg.store.packing import Range
from moseg.store.remote.connection import check_url, connect, environment
from moseg.store.remote.faults import as_store_error, is_no_bucket, is_unsupported

T = TypeVar("T")
U = TypeVar("U")

CONCURRENT = 64
"""Concurrent requests of one call. A lookup takes 10 ms to 50 ms on S3, so this gives thousands of lookups a second."""
PART_BYTES = 64 * 2**20
"""Larger objects are sent in parts of this size; for smaller ones, one request is cheaper than the three of parts."""

NEAR_BYTES = 2**20
"""Parts of an object that are no farther apart are read by one request."""


class Found(NamedTuple):
    """An object in a listing: name, bytes, time of last change (seconds since the epoch)."""

    name: str
    nbytes: int
    modified: float


def requests_for(url: str) -> "Requests":
    """Return the process's one client for a URL; a new one if the credentials in the environment changed."""
    return _requests_for(check_url(url), environment())


@lru_cache(maxsize=32)
def _requests_for(url: str, _environment: tuple[tuple[str, str], ...]) -> "Requests":
    return Requests(url)


class Requests:
    """Objects below a URL.

    Every method raises StoreError on faults of the network, the server or the credentials. A missing object is not a
    fault; a missing bucket is one, except for `has` and `has_many`: the answer to their requests does not tell the two
    apart.
    """

    def __init__(self, url: str):
        self.url = url
        self.is_store = False
        """Whether this process has found the marker here."""
        self.is_current = True
        """Return whether the marker is that of this version's format."""

    def __reduce__(self):
        return requests_for, (self.url,)

    @cached_property
    def _client(self) -> ObjectStore:
        return connect(self.url)

    def has(self, name: str) -> bool:
        """Return whether there is an object of this name."""
        with self._faults("look up objects"):
            return self._is_there(name)

    def has_many(self, names: Collection[str]) -> set[str]:
        """Return the names of which there are objects."""
        names = list(dict.fromkeys(names))
        with self._faults("look up objects"):
            found = _gather(self._is_there, names)
        return {name for name, is_there in zip(names, found, strict=True) if is_there}

    def get(self, name: str) -> bytes | None:
        """Return the content of an object, or None if there is none."""
        with self._faults("read objects"):
            try:
                return obstore.get(self._client, name).bytes().to_bytes()
            except FileNotFoundError as error:
                if is_no_bucket(error):
                    raise
                return None

    def get_many(self, names: Collection[str]) -> dict[str, bytes | None]:
        """Return the content of objects by name, in the order given; None for missing ones."""
        names = list(dict.fromkeys(names))
        return dict(zip(names, _gather(self.get, names), strict=True))

    def get_ranges(self, name: str, ranges: Mapping[str, Range]) -> dict[str, bytes] | None:
        """Return parts of an object, by name, those that are near each other in one request; None if there is none.

        A part that lies beyond the object's end is shorter than asked for.
        """
        wanted = {key: part for key, part in ranges.items() if part.nbytes}
        if not wanted:
            return dict.fromkeys(ranges, b"") if self.has(name) else None
        spans = _spans(wanted.values())

        def get_span(span: tuple[int, int]) -> bytes:
            return obstore.get_range(self._client, name, start=span[0], end=span[1]).to_bytes()

        try:
            pieces = dict(zip((start for start, _ in spans), _gather(get_span, spans), strict=True))
        except FileNotFoundError as error:
            with self._faults("read objects"):
                if is_no_bucket(error):
                    raise
            return None
        except BaseError:
            # each server has another answer for a part that begins beyond the end
            content = self.get(name)
            if content is None:
                return None
            pieces = {0: content}
        found = dict.fromkeys(ranges, b"")
        for key, (start, nbytes) in wanted.items():
            first = max(piece for piece in pieces if piece <= start)
            found[key] = pieces[first][start - first : start - first + nbytes]
        return found

    def put(self, name: str, content: bytes, purpose: str = "write objects") -> None:
        """Write or replace an object."""
        with self._faults(purpose):
            obstore.put(self._client, name, content, use_multipart=False)

    def put_many(self, files: Mapping[str, bytes | memoryview]) -> None:
        """Write or replace objects."""

        def put(name: str) -> None:
            content = files[name]
            is_long = len(content) > PART_BYTES
            obstore.put(self._client, name, content, use_multipart=is_long, chunk_size=PART_BYTES, max_concurrency=4)

        with self._faults("write objects"):
            _gather(put, files)

    def create(self, name: str, content: bytes) -> bool:
        """Write an object unless there is one of this name; return whether it was written."""
        return name in self.create_many({name: content})

    def create_many(self, files: Mapping[str, bytes]) -> set[str]:
        """Write the objects whose names do not exist yet, and return these names.

        Not every server with the protocol of S3 supports this condition. If a server rejects it, the object is looked
        up first; a server that ignores it writes. On both the last of two simultaneous writers may win.
        """

        def create(name: str) -> bool:
            try:
                obstore.put(self._client, name, files[name], mode="create", use_multipart=False)
            except AlreadyExistsError:
                return False
            except (BaseError, NotImplementedError) as error:
                if not (isinstance(error, NotSupportedError | NotImplementedError) or is_unsupported(error)):
                    raise
                if self._is_there(name):
                    return False
                obstore.put(self._client, name, files[name], use_multipart=False)
            return True

        with self._faults("write objects"):
            created = _gather(create, files)
        return {name for name, is_new in zip(files, created, strict=True) if is_new}

    def copy_many(self, names: Mapping[str, str]) -> None:
        """Copy objects, by source, to their targets, on the server; skip missing ones."""

        def copy(source: str) -> None:
            try:
                obstore.copy(self._client, source, names[source])
            except FileNotFoundError as error:
                if is_no_bucket(error):
                    raise

        with self._faults("copy objects"):
            _gather(copy, names)

    def delete(self, names: Iterable[str], purpose: str = "delete objects") -> None:
        """Delete objects; skip missing ones."""

        def delete(name: str) -> None:
            try:
                obstore.delete(self._client, name)
            except FileNotFoundError as error:
                if is_no_bucket(error):
                    raise

        with self._faults(purpose):
            _gather(delete, names)

    def listing(self, folder: str) -> Iterator[Found]:
        """Iterate over the objects below a folder, at any depth; an empty name is the root."""
        with self._faults("list objects"):
            for page in obstore.list(self._client, prefix=folder or None, chunk_size=1000):
                for item in page:
                    yield Found(item["path"], item["size"], item["last_modified"].timestamp())

    def _is_there(self, name: str) -> bool:
        try:
            obstore.head(self._client, name)
        except FileNotFoundError:
            return False
        return True

    def _faults(self, purpose: str) -> AbstractContextManager[None]:
        return as_store_error(purpose, self.url)


def _spans(parts: Iterable[Range]) -> list[tuple[int, int]]:
    """Return the first byte and the byte after the last of each request for parts, in their order in the object.

    obstore's own `get_ranges` joins parts too, but it panics if an object ends before the last of them.
    """
    spans: list[tuple[int, int]] = []
    for start, nbytes in sorted(parts):
        if spans and start - spans[-1][1] <= NEAR_BYTES:
            spans[-1] = spans[-1][0], max(spans[-1][1], start + nbytes)
        else:
            spans.append((start, start + nbytes))
    return spans


def _gather(call: Callable[[T], U], items: Iterable[T]) -> list[U]:
    """Return the results of a call on every item, in order, `CONCURRENT` at a time.

    After an error those that have not begun are cancelled. It is raised when the others have ended: what the caller
    does next must not run into a request that the server still answers.
    """
    waiting = list(items)
    if len(waiting) < 2:
        return [call(item) for item in waiting]
    futures = [_threads().submit(call, item) for item in waiting]
    try:
        return [future.result() for future in futures]
    finally:
        wait([future for future in futures if not future.cancel()])


@cache
def _threads() -> ThreadPoolExecutor:
    """Return the pool of threads for concurrent requests.

    Coroutines are not used: obstore resumes them from a thread of its own, and if the interpreter exits at that moment
    the process is aborted after its work is done.
    """
    return ThreadPoolExecutor(CONCURRENT, thread_name_prefix="moseg-requests")
