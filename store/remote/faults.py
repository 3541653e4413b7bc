"""Errors of an object store, explained in one line and without secrets.

Errors of the client print whole requests: their URLs (which for Azure may hold a signature), the server's XML and a
structure for debugging. The line gives only the answer of the server or the network.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager

from obstore.exceptions import BaseError, PermissionDeniedError, UnauthenticatedError

from moseg.schemas.errors import StoreError

_CODE = re.compile(r"<Code>(\w+)</Code>")
_STATUS = re.compile(r"status code: (\d{3} [A-Za-z -]+)")
_SERVER = re.compile(r"https?://[^/\s?\"@]+")
_SYSTEM = re.compile(r'(?:message|error): "([^"]+)"')
_URL_REST = re.compile(r"(https?://[^/\s?\"]+)[^\s\"]*")
_GENERIC = re.compile(r"^Generic \w+ error: ")
_METADATA_SERVICES = ("http://169.254.169.254", "http://metadata.google.internal")
_MEANINGS = {
    "NoSuchBucket": "no such bucket",
    "ContainerNotFound": "no such container",
    "AccessDenied": "access denied",
    "InvalidAccessKeyId": "the access key is unknown to the server",
    "SignatureDoesNotMatch": "the secret key is not the access key's",
    "ExpiredToken": "the credentials have expired",
    "InvalidToken": "the session token is refused",
    "AuthorizationHeaderMalformed": "the bucket is in another region than AWS_REGION says",
    "PermanentRedirect": "the bucket is in another region than AWS_REGION says",
}
_LONGEST = 160
_PASSING = re.compile(
    r"no answer in time|the server answers (5(?!01)\d\d|408|429|SlowDown|InternalError|ServiceUnavailable"
    r"|RequestTimeout|TooManyRequests|ServerBusy)\b"
)
"""Reasons of a server that may answer later, which no other choice of the user would change."""


@contextmanager
def as_store_error(purpose: str, where: str) -> Iterator[None]:
    """Convert errors of the client to StoreErrors that read ``cannot <purpose>: <reason>``."""
    try:
        yield
    except StoreError:
        raise
    except (BaseError, OSError, NotImplementedError) as error:
        raise StoreError(f"cannot {purpose}: {explain(error)}", where=where) from None


def explain(error: BaseException) -> str:
    """Explain a client's error in a few words."""
    text = str(error)
    line, _, details = text.partition("\n\nDebug source:")
    server = _SERVER.search(line)
    at = f" at {server[0]}" if server else ""
    if server and server[0] in _METADATA_SERVICES:
        # the client requests a machine's own credentials if the environment has none
        return "no credentials in the environment, and none of this machine"
    if code := _CODE.search(line):
        return _MEANINGS.get(code[1], f"the server answers {code[1]}{at}")
    if "redirect without LOCATION" in line:
        return "the bucket is in another region than AWS_REGION says"
    if isinstance(error, PermissionDeniedError | UnauthenticatedError):
        return f"access denied{at}"
    if status := _STATUS.search(line):
        return f"the server answers {status[1].strip()}{at}"
    if "kind: Connect" in details:
        reason = _SYSTEM.search(details)
        to = f" to {server[0]}" if server else ""
        return f"cannot connect{to}{f' ({reason[1]})' if reason else ''}"
    if "kind: Timeout" in details or "timed out" in line:
        return f"no answer in time{at}"
    return _URL_REST.sub(r"\1", _GENERIC.sub("", " ".join(line.split())))[:_LONGEST]


def is_passing(reason: str) -> bool:
    """Return whether a reason, as `explain` gives it, is a fault of the server that may pass."""
    return _PASSING.match(reason) is not None


def is_no_bucket(error: BaseException) -> bool:
    """Return whether the whole bucket, not only an object, was not found."""
    code = _CODE.search(str(error))
    return code is not None and code[1] in ("NoSuchBucket", "ContainerNotFound")


def is_unsupported(error: BaseException) -> bool:
    """Return whether the server does not support the request."""
    line = str(error).partition("\n\nDebug source:")[0]
    return "status code: 501" in line or "<Code>NotImplemented</Code>" in line
