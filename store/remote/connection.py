"""Connection to an object store: a client from a URL and the environment.

The environment variables are those that other tools of the provider read. For S3:

- ``AWS_ACCESS_KEY_ID``, ``AWS_SECRET_ACCESS_KEY``, ``AWS_SESSION_TOKEN``;
- ``AWS_REGION``, else ``AWS_DEFAULT_REGION``, else ``us-east-1``;
- ``AWS_ENDPOINT_URL_S3``, else ``AWS_ENDPOINT_URL``: a server other than Amazon's, over ``https://`` or ``http://``;
- ``AWS_SKIP_SIGNATURE=true`` for a public bucket.

Without keys, and if boto3 is installed, its session finds them, with the region and the endpoint: profiles
(``AWS_PROFILE``), single sign-on, roles of containers and of machines, renewed before they expire. Without boto3 the
roles of containers and machines are still found. Google's ``GOOGLE_APPLICATION_CREDENTIALS`` and Azure's
``AZURE_STORAGE_ACCOUNT_NAME`` with ``AZURE_STORAGE_ACCOUNT_KEY`` (or a token, or a client's secret) are read as they
are by these providers' tools.

Credentials stay in the process that read them: a store that is sent to a worker is a URL, and the worker reads its own
environment.
"""

import os
import re
from collections.abc import Mapping
from datetime import timedelta
from functools import lru_cache
from importlib.util import find_spec
from typing import Any
from urllib.parse import SplitResult, urlsplit

from obstore.exceptions import BaseError
from obstore.store import ObjectStore, from_url

from moseg.schemas.errors import InputError, StoreChoiceError
from moseg.store.remote.faults import explain

S3_SCHEMES = ("s3", "s3a")
_BUCKET = re.compile(r"[A-Za-z0-9][A-Za-z0-9@._-]*")
_PROVIDERS = ("AWS_", "AZURE_", "GOOGLE_")
_CLIENT_OPTIONS = {
    # A reachable machine accepts a connection within milliseconds; a transfer may take longer, as long as data arrive:
    # five minutes for a request's whole body are 13 MB/s for the largest possible chunk.
    "connect_timeout": timedelta(seconds=4),
    "read_timeout": timedelta(seconds=20),
    "timeout": timedelta(seconds=300),
}
_RETRIES = {
    # 0.1 s, 0.2 s, ... 1.6 s: longer than a server's short refusals ("slow down"); a missing server is found in 3 s
    "max_retries": 5,
    "retry_timeout": timedelta(seconds=40),
    "backoff": {"init_backoff": timedelta(milliseconds=100), "max_backoff": timedelta(seconds=5), "base": 2},
}


def check_url(url: str) -> str:
    """Return the URL without slashes at its end.

    Raises InputError if it holds more than scheme, bucket and path. The message omits the rejected part: it may be a
    secret.
    """
    parts = urlsplit(url)
    if parts.password is not None or (parts.username is not None and parts.scheme not in ("abfs", "abfss")):
        raise InputError("credentials in a store's URL", where=_bare(parts), expected="credentials in the environment")
    if parts.query or parts.fragment:
        raise InputError("more than a path in a store's URL", where=_bare(parts), expected="scheme://bucket/prefix")
    if not _BUCKET.fullmatch(parts.netloc):
        raise InputError(
            "bad bucket in a store's URL", where=_bare(parts), expected="letters, digits, '.', '_' and '-'"
        )
    return url.rstrip("/")


def connect(url: str) -> ObjectStore:
    """Return a client for the objects below a URL.

    Raises StoreChoiceError if the URL or the environment is invalid; no request is made.
    """
    is_s3 = urlsplit(url).scheme in S3_SCHEMES
    try:
        config, provider = s3_settings(os.environ) if is_s3 else ({}, None)
        is_plain = config.get("endpoint", "").startswith("http://")
        return from_url(
            url,
            config=config or None,
            client_options=_CLIENT_OPTIONS | ({"allow_http": True} if is_plain else {}),
            retry_config=_RETRIES,
            **({"credential_provider": provider} if provider is not None else {}),
        )
    except StoreChoiceError as error:
        what, _, got, expected = error.parts
        raise StoreChoiceError(what, where=url, got=got, expected=expected) from None
    except InputError:
        raise
    except (BaseError, ValueError) as error:
        raise StoreChoiceError(f"cannot use the object store: {explain(error)}", where=url) from None


def environment() -> tuple[tuple[str, str], ...]:
    """Return the variables of the process's environment that concern object stores."""
    return tuple(sorted(item for item in os.environ.items() if item[0].startswith(_PROVIDERS)))


def s3_settings(environ: Mapping[str, str]) -> tuple[dict[str, Any], Any]:
    """Return the settings of a client for S3 and its provider of credentials, None if the environment has these."""
    region = environ.get("AWS_REGION") or environ.get("AWS_DEFAULT_REGION")
    endpoint = environ.get("AWS_ENDPOINT_URL_S3") or environ.get("AWS_ENDPOINT_URL")
    provider = None
    has_keys = environ.get("AWS_ACCESS_KEY_ID") or environ.get("AWS_SKIP_SIGNATURE", "").lower() in ("1", "true")
    if not has_keys and find_spec("boto3") is not None:
        provider, found_region, found_endpoint = _boto_session(environ.get("AWS_PROFILE"))
        region, endpoint = region or found_region, endpoint or found_endpoint
    if endpoint:
        _check_endpoint(endpoint)
    settings = {"region": region, "endpoint": endpoint and endpoint.rstrip("/")}
    return {name: value for name, value in settings.items() if value}, provider


@lru_cache(maxsize=8)
def _boto_session(profile: str | None) -> tuple[Any, str | None, str | None]:
    """Return credentials, region and endpoint from boto3; raises StoreChoiceError if there are no credentials."""
    import botocore.session
    from botocore.exceptions import BotoCoreError
    from obstore.auth.boto3 import Boto3CredentialProvider

    try:
        session = botocore.session.Session(profile=profile)
        region = session.get_config_variable("region")
        endpoint = session.get_scoped_config().get("endpoint_url")
        if session.get_credentials() is None:
            raise StoreChoiceError(
                "no credentials", expected="AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or a profile"
            )
        return Boto3CredentialProvider(session), region, endpoint
    except BotoCoreError as error:
        raise StoreChoiceError(f"no credentials: {error}") from None


def _check_endpoint(endpoint: str) -> None:
    """Raise InputError unless the endpoint is an address to which the client can connect."""
    parts = urlsplit(endpoint)
    if parts.scheme not in ("http", "https") or not parts.hostname or "@" in parts.netloc:
        raise InputError(
            "bad address of a server", where="AWS_ENDPOINT_URL", expected="https://host or http://host:port"
        )


def _bare(parts: SplitResult) -> str:
    """Return a URL without parts that could be secret."""
    return f"{parts.scheme}://{parts.hostname or ''}{parts.path}"
