"""Requests to a server, over https only and with a token for one host, and what their failures mean to the user."""

import re
import ssl
import time
import urllib.request
from collections.abc import Mapping
from email.utils import parsedate_to_datetime
from http.client import HTTPException, HTTPResponse, InvalidURL
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import getproxies, proxy_bypass

from moseg.schemas.errors import InputError
from moseg.schemas.weights import LOOPBACK, is_trusted_url

TIMEOUT_SEC = 30.0
"""Time after which a request to a server that sends nothing fails."""
USER_AGENT = "moseg"


def open_url(url: str, headers: Mapping[str, str], token: str | None) -> HTTPResponse:
    """Return the response to a GET; raise as `urllib.request` does (HTTPError, URLError), or HTTPException."""
    request = urllib.request.Request(url, headers={"User-Agent": USER_AGENT, **headers})
    if token:
        request.add_unredirected_header("Authorization", f"Bearer {token}")
    # A proxy is for other machines only.
    local = [urllib.request.ProxyHandler({})] if urlsplit(url).hostname in LOOPBACK else []
    try:
        return urllib.request.build_opener(_Redirects, *local).open(request, timeout=TIMEOUT_SEC)
    # A malformed address, of a redirect or of a proxy: it is parsed in many places, each with its own error.
    except ValueError as error:
        raise InvalidURL(str(error)) from error


def read_url(url: str, limit: int, token: str | None) -> bytes:
    """Return the first `limit` bytes of the response of an address.

    Raises
    ------
    InputError
        The request failed; the message gives the reason.
    """
    try:
        with open_url(url, {}, token) as response:
            return response.read(limit)
    except (OSError, HTTPException) as error:
        raise explain(error, url) from error


def _is_loopback(url: str) -> bool:
    return urlsplit(url).hostname in LOOPBACK


class _Redirects(urllib.request.HTTPRedirectHandler):
    """A handler that follows redirects to trusted addresses only, and sends the token to its own host only."""

    def redirect_request(self, req, fp, code, msg, headers, newurl):
        if not is_trusted_url(newurl) or (_is_loopback(newurl) and not _is_loopback(req.full_url)):
            raise HTTPError(req.full_url, code, f"redirected to {newurl}, which is no https address", headers, fp)
        new = super().redirect_request(req, fp, code, msg, headers, newurl)
        old, target = urlsplit(req.full_url), urlsplit(newurl)
        token = req.unredirected_hdrs.get("Authorization")
        if new is not None and token and (old.scheme, old.netloc) == (target.scheme, target.netloc):
            new.add_unredirected_header("Authorization", token)
        return new


FORBIDDEN, GONE, BUSY = (401, 403), (404, 410), (425, 429, 503)
TRANSIENT = (*BUSY, 408, 500, 502, 504)
"""Status codes after which another try may succeed."""


def explain(error: Exception, url: str, homepage: str = "") -> InputError:
    """Return the user's error for a failed request; `homepage` is a page about the file."""
    if isinstance(error, HTTPError):
        error.close()
        return _explain_answer(error, url, homepage or url)
    reason = error.reason if isinstance(error, URLError) else error
    if isinstance(reason, ssl.SSLError):
        return InputError("the server's certificate is not trusted", where=url, got=reason)
    proxy = _proxy(url)
    if proxy:
        got = getattr(reason, "strerror", None) or reason
        expected = f"a proxy that answers at {proxy}, or none: see {urlsplit(url).scheme}_proxy"
        return InputError("no connection through the proxy", where=url, got=got, expected=expected)
    if isinstance(reason, OSError):
        expected = "a network; without one, the files in the folder of weights"
        return InputError("no connection to the server", where=url, got=reason.strerror or reason, expected=expected)
    return InputError("the server's answer cannot be read", where=url, got=repr(reason))


def retry_after_sec(answer: HTTPError) -> float:
    """Return how long a busy server asks to wait, s; 0 if it does not say."""
    text = answer.headers.get("Retry-After", "")
    if re.fullmatch(r"\d{1,9}", text):
        return float(text)
    try:
        return max(0.0, parsedate_to_datetime(text).timestamp() - time.time())
    except (ValueError, OverflowError):
        return 0.0


def _explain_answer(error: HTTPError, url: str, page: str) -> InputError:
    got = f"{error.code} {error.reason}"
    if error.code in FORBIDDEN:
        expected = f"access: see {page}; where it asks for a login, set HF_TOKEN to your token for huggingface.co"
        return InputError("the server gives no access", where=url, got=got, expected=expected)
    if error.code in GONE:
        expected = f"the file; it may have moved, see {page}"
        return InputError("the server has no such file", where=url, got=got, expected=expected)
    if error.code in TRANSIENT:
        what = "the server is busy" if error.code in BUSY else "the server fails"
        wait_sec = retry_after_sec(error)
        expected = f"another try {f'in {wait_sec:.0f} s' if wait_sec else 'later'}"
        return InputError(what, where=url, got=got, expected=expected)
    return InputError("the server refuses", where=url, got=got)


def _proxy(url: str) -> str:
    """Return host and port of the proxy for an address, without its password; empty if there is none."""
    parts = urlsplit(url)
    proxy = getproxies().get(parts.scheme, "")
    if not proxy or parts.hostname in LOOPBACK or proxy_bypass(parts.netloc):
        return ""
    return proxy.rpartition("//")[2].rpartition("@")[2].rstrip("/")
