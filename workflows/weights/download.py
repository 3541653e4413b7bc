"""Download of one file: resumed after an interruption, checked, and then renamed to its place.

The bytes go to ``<file>.partial``. A download that is interrupted leaves it there, and the next one requests only the
rest. A complete file is compared with the size and digest that it must have: a wrong file is deleted, a right one is
renamed.

huggingface_hub (2.4) is not used for the hub's items: it accepts bytes of the right length with another SHA-256, starts
again after a killed process, only warns of a full disk, and comes with torch (extra ``models``), without which weights
can be fetched here. RAFT, DeAOT, RAM's tags and a user's own addresses would need this module beside it.
"""

import os
import re
import shutil
import time
from collections.abc import Callable
from http.client import HTTPException, HTTPResponse
from pathlib import Path
from typing import NamedTuple
from urllib.error import HTTPError

from moseg.schemas.errors import InputError, StoreError
from moseg.workflows.process.atomic_write import blame_output
from moseg.workflows.weights.connection import TRANSIENT, explain, open_url, retry_after_sec
from moseg.workflows.weights.pins import sha256_of

CHUNK_BYTES = 2**20
PARTIAL_SUFFIX = ".partial"
NO_SUCH_RANGE = 416
MAX_WAIT_SEC = 60.0
"""The download ends if a server asks for a longer wait."""
_RANGE = re.compile(r"bytes (?:(?P<start>\d{1,18})-\d+|\*)/(?P<total>\d{1,18}|\*)")

Report = Callable[[int, int | None], None]
"""Takes how many bytes were received, and of how many if that is known."""
Record = Callable[["Downloaded"], None]
"""Takes what was received, before it has its name: a kill then never leaves a file that is not recorded."""


class Source(NamedTuple):
    """Address of a file and what the file must be; None if that is not known beforehand."""

    url: str
    sha256: str | None = None
    size: int | None = None
    token: str | None = None
    homepage: str = ""


class Retries(NamedTuple):
    """How often a request is repeated after one that yielded no new bytes, and the wait before the first repetition."""

    count: int = 4
    wait_sec: float = 1.0


class Downloaded(NamedTuple):
    """Digest and size of the file that was received."""

    sha256: str
    size: int


class _Cut(Exception):
    """The connection ended before the file did, or `answer` says to try later."""

    def __init__(self, reason: object, answer: HTTPError | None = None):
        super().__init__(reason)
        self.answer = answer


def download(
    source: Source,
    target: Path,
    report: Report,
    retries: Retries | None = None,
    record: Record = lambda found: None,
) -> Downloaded:
    """Download a file to `target`, whose folder exists.

    Raises
    ------
    InputError
        The server cannot be reached, gives no access, has no such file or sends another one; the connection is cut
        repeatedly; the folder cannot be written. `target` is then as it was before, as it is with the next error.
    StoreError
        The disk is full or fails.
    """
    partial = target.with_name(target.name + PARTIAL_SUFFIX)
    # The rest of an earlier download may be damaged: then the file is downloaded once more from its beginning.
    for is_last in (not partial.exists(), True):
        _Transfer(source, partial, report, retries or Retries()).receive()
        found = Downloaded(sha256_of(partial), partial.stat().st_size)
        if source.size in (None, found.size) and source.sha256 in (None, found.sha256):
            break
        partial.unlink()
        if is_last:
            got, expected = f"SHA-256 {found.sha256}", source.sha256
            if source.size not in (None, found.size):
                got, expected = f"{found.size} bytes", source.size
            expected = f"{expected}; what was downloaded is deleted"
            raise InputError("a wrong file was downloaded", where=source.url, got=got, expected=expected)
    record(found)
    with blame_output(target):
        os.replace(partial, target)
    return found


class _Transfer:
    """The requests for one file."""

    def __init__(self, source: Source, partial: Path, report: Report, retries: Retries):
        self._source = source
        self._partial = partial
        self._report = report
        self._retries = retries
        self._etag: str | None = None
        self._total: int | None = None

    def receive(self) -> None:
        """Request what is missing until the file is complete."""
        furthest = failures = 0
        is_first = True
        while True:
            try:
                self._request(is_first)
                return
            except _Cut as cut:
                is_first = False
                reached = self._reached()
                failures = 1 if reached > furthest else failures + 1
                furthest = max(reached, furthest)
                asked_sec = 0.0 if cut.answer is None else retry_after_sec(cut.answer)
                if failures > self._retries.count or asked_sec > MAX_WAIT_SEC:
                    raise self._failure(cut, reached) from cut
                time.sleep(max(asked_sec, self._retries.wait_sec * 2 ** (failures - 1)))

    def _failure(self, cut: _Cut, reached: int) -> InputError:
        """Return the error of a file that cannot be downloaded now, but perhaps later."""
        if cut.answer is not None:
            return explain(cut.answer, self._source.url, self._source.homepage)
        got = f"{reached} of {self._source.size or 'unknown'} bytes ({cut})"
        expected = "a connection that lasts; the same command goes on from there"
        return InputError("the download was cut off", where=self._source.url, got=got, expected=expected)

    def _request(self, is_first: bool) -> None:
        """Request the rest of the file once; raise _Cut if another request may get further."""
        if self._source.sha256 is None and self._etag is None:
            # Parts of two versions of the file could be joined unnoticed.
            self._partial.unlink(missing_ok=True)
        start = self._reached()
        if self._source.size is not None and start >= self._source.size:
            return
        headers = {"Range": f"bytes={start}-"} if start else {}
        if start and self._etag:
            headers["If-Range"] = self._etag
        try:
            response = open_url(self._source.url, headers, self._source.token)
        except HTTPError as error:
            if error.code == NO_SUCH_RANGE and start:
                self._end_range(error, start)
            elif error.code in TRANSIENT:
                error.close()
                raise _Cut("the server asks to try later", error) from error
            else:
                raise explain(error, self._source.url, self._source.homepage) from error
        except (OSError, HTTPException) as error:
            # A server that was reached before may come back; one that never was is not there.
            if is_first:
                raise explain(error, self._source.url, self._source.homepage) from error
            raise _Cut(error) from error
        else:
            with response:
                self._receive_body(response, start)

    def _end_range(self, error: HTTPError, start: int) -> None:
        """Accept that the server has no more bytes; delete what is here if the file has another length."""
        error.close()
        match = _RANGE.fullmatch(error.headers.get("Content-Range", ""))
        if match is None or match["total"] != str(start) or self._total not in (None, start):
            self._partial.unlink()
            self._etag = self._total = None
            raise _Cut("the server has no such range") from error

    def _receive_body(self, response: HTTPResponse, start: int) -> None:
        start, total = self._accept(response, start)
        self._check_answer(response, total)
        free = shutil.disk_usage(self._partial.parent).free
        if response.length is not None and response.length > free:
            where, expected = self._partial.parent, f"{response.length} bytes"
            raise StoreError("no room on the disk", where=where, got=f"{free} bytes free", expected=expected)
        done = start
        with blame_output(self._partial), open(self._partial, "ab" if start else "wb") as file:
            self._report(done, total)
            while chunk := _read(response):
                file.write(chunk)
                done += len(chunk)
                self._report(done, total)
                if self._source.size is not None and done > self._source.size:
                    break
            file.flush()
            os.fsync(file.fileno())
        # A server that does not send the length ends a complete and a cut response alike.
        whole = self._source.size if total is None else total
        if whole is not None and done < whole:
            raise _Cut("the server closed the connection")
        if done == 0:
            self._partial.unlink()
            raise InputError("the server sent an empty file", where=self._source.url, got="0 bytes")

    def _accept(self, response: HTTPResponse, start: int) -> tuple[int, int | None]:
        """Return where the response begins and how long the file is, and note which version of the file this is.

        It begins at 0 if the server ignores ranges or has another file by now.
        """
        tag = response.headers.get("ETag", "")
        tag = tag if tag.startswith('"') else None
        total = response.length
        if response.status == 206:
            match = _RANGE.fullmatch(response.headers.get("Content-Range", ""))
            if match is None or match["start"] != str(start):
                raise _Cut("the server sent another range")
            if match["total"] != "*":
                total = int(match["total"])
            elif total is not None:
                total += start
            # Not every server, and not every cache before it, heeds If-Range.
            if self._is_another_version(tag, total):
                self._partial.unlink(missing_ok=True)
                self._etag = self._total = None
                raise _Cut("the server has another version of the file")
        else:
            start = 0
        self._etag, self._total = tag, total
        return start, total

    def _is_another_version(self, tag: str | None, total: int | None) -> bool:
        """Return whether a part cannot belong to what was received before."""
        # A part without a tag may be of any version; the digest, if it is known, tells later.
        if self._etag is not None and tag != self._etag and (tag is not None or self._source.sha256 is None):
            return True
        return None not in (total, self._total) and total != self._total

    def _check_answer(self, response: HTTPResponse, total: int | None) -> None:
        """Raise InputError for a response that cannot be the file, before it is downloaded."""
        url, size = self._source.url, self._source.size
        if response.headers.get_content_type() == "text/html":
            page = self._source.homepage or url
            expected = f"the file; if this lasts (a quota, a login) get it by hand, see {page}"
            raise InputError("the server sent a web page", where=url, got="text/html", expected=expected)
        if total is not None and size not in (None, total):
            raise InputError("a wrong file is offered", where=url, got=f"{total} bytes", expected=f"{size} bytes")
        if total is None and not response.chunked and size is None and self._source.sha256 is None:
            page = self._source.homepage or url
            expected = f"its length, as neither size nor SHA-256 is known; or get the file by hand, see {page}"
            raise InputError("the server does not say how long the file is", where=url, expected=expected)

    def _reached(self) -> int:
        return self._partial.stat().st_size if self._partial.exists() else 0


def _read(response: HTTPResponse) -> bytes:
    try:
        return response.read1(CHUNK_BYTES)
    except (OSError, HTTPException) as error:
        raise _Cut(error) from error
