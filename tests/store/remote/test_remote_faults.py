"""Explanations of errors of the server, the network or the client, without secrets."""

import pytest
from obstore.exceptions import GenericError, PermissionDeniedError, UnauthenticatedError

from moseg.schemas.errors import StoreChoiceError, StoreError
from moseg.store.remote.faults import as_store_error, explain, is_no_bucket, is_unsupported
from moseg.store.remote.layout import open_prefix
from moseg.store.remote.requests import Requests

SECRET = "sig=a-secret"
AZURE = f"Error performing GET https://me.blob.core.windows.net/c/p/x?sv=1&{SECRET} in 3ms"
DEBUG = f"\n\nDebug source:\nGeneric {{ uri: https://me.blob.core.windows.net/c?{SECRET}"


def answer(status: str, code: str = "") -> str:
    body = f"<Error><Code>{code}</Code><Message>{SECRET}</Message></Error>" if code else ""
    return f"{AZURE} - Server returned non-2xx status code: {status}: {body}{DEBUG}"


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (FileNotFoundError(answer("404 Not Found", "NoSuchBucket")), "no such bucket"),
        (PermissionDeniedError(answer("403 Forbidden", "AccessDenied")), "access denied"),
        (PermissionDeniedError(answer("403 Forbidden")), "access denied at https://me.blob.core.windows.net"),
        (UnauthenticatedError(answer("401 Unauthorized")), "access denied at https://me.blob.core.windows.net"),
        (PermissionDeniedError(answer("403 Forbidden", "ExpiredToken")), "the credentials have expired"),
        (GenericError(answer("400 Bad Request", "OddOne")), "the server answers OddOne at https://me.blob"),
        (GenericError(answer("503 Slow Down")), "the server answers 503 Slow Down at https://me.blob"),
        (
            GenericError(f"{AZURE} - HTTP error: error sending request{DEBUG} kind: Connect"),
            "cannot connect to https://me",
        ),
        (
            GenericError(f"{AZURE} - HTTP error: error sending request{DEBUG} kind: Timeout"),
            "no answer in time at https",
        ),
        (
            GenericError(f"Generic S3 error: {AZURE} odd"),
            "Error performing GET https://me.blob.core.windows.net in 3ms odd",
        ),
        (GenericError("Received redirect without LOCATION, this normally indicates…"), "in another region"),
        (GenericError("GET http://169.254.169.254/latest/x - status code: 404 Not Found"), "no credentials"),
        (GenericError("x" * 1000), "x" * 100),
    ],
)
def test_errors_are_one_short_line_without_secrets(error, reason):
    found = explain(error)
    assert reason in found
    assert "a-secret" not in found and "\n" not in found and len(found) < 200
    with (
        pytest.raises(StoreError, match="cannot read objects") as caught,
        as_store_error("read objects", "s3://bucket/p"),
    ):
        raise error
    assert "a-secret" not in str(caught.value) and caught.value.__suppress_context__


@pytest.mark.parametrize(
    ("reason", "is_a_fault"),
    [
        ("the server answers SlowDown at http://s3:9000", True),
        ("the server answers 503 Service Unavailable at http://s3:9000", True),
        ("no answer in time at http://s3:9000", True),
        ("the server answers 408 Request Timeout at http://s3:9000", True),
        ("the server answers 429 Too Many Requests at http://s3:9000", True),
        ("the server answers TooManyRequests at http://s3:9000", True),
        ("the server answers ServerBusy at http://s3:9000", True),
        ("the server answers 404 Not Found", False),
        ("the server answers MalformedXML", False),
        ("the server answers 501 Not Implemented", False),
        ("no such bucket", False),
        ("cannot connect to http://s3:9000", False),
    ],
)
def test_a_fault_of_the_server_at_the_start_is_not_bad_input(monkeypatch, reason, is_a_fault):
    requests = Requests("memory://")

    def fail(name):
        raise StoreError(f"cannot read objects: {reason}", where=requests.url)

    monkeypatch.setattr(requests, "get", fail)
    with pytest.raises(StoreError, match=reason) as caught:
        open_prefix(requests, create=True)
    assert isinstance(caught.value, StoreChoiceError) != is_a_fault


def test_a_missing_object_is_not_a_missing_bucket():
    assert is_no_bucket(FileNotFoundError(answer("404 Not Found", "NoSuchBucket")))
    assert not is_no_bucket(FileNotFoundError(answer("404 Not Found", "NoSuchKey")))
    assert not is_no_bucket(FileNotFoundError(answer("404 Not Found")))


def test_only_requests_that_a_server_does_not_implement_are_unsupported():
    assert is_unsupported(GenericError(answer("501 Not Implemented")))
    assert is_unsupported(GenericError(answer("400 Bad Request", "NotImplemented")))
    assert not is_unsupported(GenericError(answer("500 Internal Server Error")))
    assert not is_unsupported(PermissionDeniedError(answer("403 Forbidden")))
