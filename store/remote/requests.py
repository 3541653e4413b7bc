"""Requests to an object store, several at a time, by names relative to the store's root."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from functools import cache, cached_property, lru_cache
from typing import NamedTuple, TypeVar

import obstore
from obstore.exceptions import AlreadyExistsError, BaseError, NotSupportedError
from obstore.store import ObjectStore

from moseg.store.remote.connection import check_url, connect, environment
from moseg.store.remote.faults import as_store_error, is_no_bucket, is_unsupported

T = TypeVar("T")
U = TypeVar("U")

CONCURRENT = 64
"""Requests of one call in flight. A lookup takes 10 ms to 50 ms on S3, so that thousands a second are looked up."""
PART_BYTES = 64 * 2**20
"""Objects above are sent in parts of this size; below, one request is cheaper than the three of an upload in parts."""


class Found(NamedTuple):
    """An object in a listing: name, bytes, time of last change (seconds since the epoch)."""

    name: str
    nbytes: int
    modified: float


def requests_for(url: str) -> "Requests":
    """The process's one client for a URL, made anew where the environment's credentials are others."""
    return _requests_for(check_url(url), environment())


@lru_cache(maxsize=32)
def _requests_for(url: str, _environment: tuple[tuple[str, str], ...]) -> "Requests":
    return Requests(url)


class Requests:
    """Objects below a URL.

    Every method raises StoreError on faults of the network, the server or the credentials. What is not there is no
    fault, but a bucket that is not there is one.
    """

    def __init__(self, url: str):
        self.url = url
        self.is_store = False
        """Whether the marker was found here by this process."""

    def __reduce__(self):
        return requests_for, (self.url,)

    @cached_property
    def _client(self) -> ObjectStore:
        return connect(self.url)

    def has(self, name: str) -> bool:
        """Whether there is an object of this name."""
        with self._faults("look up objects"):
            return self._is_there(name)

    def has_many(self, names: Collection[str]) -> set[str]:
        """Those of the names of which there are objects."""
        names = list(dict.fromkeys(names))
        with self._faults("look up objects"):
            found = _gather(self._is_there, names)
        return {name for name, is_there in zip(names, found, strict=True) if is_there}

    def get(self, name: str) -> bytes | None:
        """Content of an object; None where there is none."""
        with self._faults("read objects"):
            try:
                return obstore.get(self._client, name).bytes().to_bytes()
            except FileNotFoundError as error:
                if is_no_bucket(error):
                    raise
                return None

    def get_many(self, names: Collection[str]) -> dict[str, bytes | None]:
        """Content of objects by name, in the order given; None of those that are not there."""
        names = list(dict.fromkeys(names))
        return dict(zip(names, _gather(self.get, names), strict=True))

    def put(self, name: str, content: bytes, purpose: str = "write objects") -> None:
        """Write an object, in place of an earlier one."""
        with self._faults(purpose):
            obstore.put(self._client, name, content, use_multipart=False)

    def put_many(self, files: Mapping[str, bytes | memoryview]) -> None:
        """Write objects, in place of earlier ones."""

        def put(name: str) -> None:
            content = files[name]
            is_long = len(content) > PART_BYTES
            obstore.put(self._client, name, content, use_multipart=is_long, chunk_size=PART_BYTES, max_concurrency=4)

        with self._faults("write objects"):
            _gather(put, files)

    def create(self, name: str, content: bytes) -> bool:
        """Write an object unless there is one of this name; False where there is."""
        return name in self.create_many({name: content})

    def create_many(self, files: Mapping[str, bytes]) -> set[str]:
        """Write those objects of whose names there are none, and give their names.

        Not every server that speaks the protocol of S3 knows this condition. One that says so is asked first whether
        the object is there; one that ignores it writes. On both the last of two writers at the same moment may win.
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
        """Copy objects, by source, to their targets, on the server; those that are not there are passed over."""

        def copy(source: str) -> None:
            try:
                obstore.copy(self._client, source, names[source])
            except FileNotFoundError as error:
                if is_no_bucket(error):
                    raise

        with self._faults("copy objects"):
            _gather(copy, names)

    def delete(self, names: Iterable[str], purpose: str = "delete objects") -> None:
        """Delete objects; those that are not there are passed over."""

        def delete(name: str) -> None:
            try:
                obstore.delete(self._client, name)
            except FileNotFoundError as error:
                if is_no_bucket(error):
                    raise

        with self._faults(purpose):
            _gather(delete, names)

    def listing(self, folder: str) -> Iterator[Found]:
        """Objects below a folder, or below all with an empty name, of any depth."""
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


def _gather(call: Callable[[T], U], items: Iterable[T]) -> list[U]:
    """Results of a call on every item, in order, `CONCURRENT` at a time; the first error ends all."""
    waiting = list(items)
    if len(waiting) < 2:
        return [call(item) for item in waiting]
    futures = [_threads().submit(call, item) for item in waiting]
    try:
        return [future.result() for future in futures]
    finally:
        for future in futures:
            future.cancel()


@cache
def _threads() -> ThreadPoolExecutor:
    """Threads for requests at the same time.

    Not coroutines: obstore wakes those from a thread of its own, and where the interpreter ends just then the process
    is aborted after its work is done.
    """
    return ThreadPoolExecutor(CONCURRENT, thread_name_prefix="moseg-requests")
