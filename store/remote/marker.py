"""The marker that makes the objects below a URL a store."""

from moseg.schemas.errors import MissingStoreError, StoreChoiceError, StoreError
from moseg.store.marker import CONTENT, MARKER, check_marker
from moseg.store.remote.requests import Requests


def open_prefix(requests: Requests, *, create: bool) -> None:
    """Check a store's marker, once in a process, or make an empty prefix a store.

    Raises
    ------
    StoreChoiceError
        There is no store (and none to be made), other objects lie there, the format is another, or the bucket cannot
        be had: no such bucket, no access, no connection.
    """
    if requests.is_store:
        return
    try:
        content = requests.get(MARKER)
        if content is None:
            content = _create(requests, create=create)
    except StoreChoiceError:
        raise
    except StoreError as error:
        _, _, reason = error.parts[0].partition(": ")
        raise StoreChoiceError(f"cannot open the artifact store: {reason}", where=requests.url) from None
    check_marker(content, f"{requests.url}/{MARKER}")
    requests.is_store = True


def _create(requests: Requests, *, create: bool) -> bytes:
    foreign = next(requests.listing(""), None)
    if foreign is not None and foreign.name != MARKER:
        raise StoreChoiceError(
            "not an artifact store", where=requests.url, got=foreign.name, expected="an empty prefix or a store"
        )
    if not create:
        raise MissingStoreError("no artifact store", where=requests.url, expected=f"a prefix with {MARKER}")
    if requests.create(MARKER, CONTENT):
        return CONTENT
    return requests.get(MARKER) or b""
