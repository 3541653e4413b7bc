"""Asking a server: over https only, with a token that no other host sees, and errors that say what to do."""

import ssl
import urllib.request
from collections.abc import Mapping
from http.client import HTTPException, HTTPResponse
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit

from schemas.errors import InputError
from schemas.weights import LOOPBACK, is_trusted_url

TIMEOUT_SEC = 30.0
"""Longest silence of a server that is waited for."""
USER_AGENT = "moseg"
FORBIDDEN = (401, 403)
PASSING = (408, 425, 429, 500, 502, 503, 504)
"""Answers that another try may not get."""


def open_url(url: str, headers: Mapping[str, str], token: str | None) -> HTTPResponse:
    """The answer to a GET; raises as `urllib.request` does (HTTPError, URLError), or HTTPException."""
    request = urllib.request.Request(url, headers={"User-Agent": USER_AGENT, **headers})
    if token:
        request.add_unredirected_header("Authorization", f"Bearer {token}")
    # A proxy is for what lies outside.
    proxies = [urllib.request.ProxyHandler({})] if urlsplit(url).hostname in LOOPBACK else []
    return urllib.request.build_opener(_Redirects, *proxies).open(request, timeout=TIMEOUT_SEC)


def read_url(url: str, limit: int, token: str | None) -> bytes:
    """The first `limit` bytes of what an address answers.

    Raises
    ------
    InputError
        It cannot be had; says why.
    """
    try:
        with open_url(url, {}, token) as response:
            return response.read(limit)
    except (OSError, HTTPException) as error:
        raise explain(error, url) from error


def explain(error: Exception, url: str, homepage: str = "") -> InputError:
    """What a failed request means to the user."""
    page = homepage or url
    if isinstance(error, HTTPError):
        error.close()
        answer = f"{error.code} {error.reason}"
        if error.code in FORBIDDEN:
            expected = f"access: see {page}; where it asks for a login, set HF_TOKEN to your token for huggingface.co"
            return InputError("the server gives no access", where=url, got=answer, expected=expected)
        if error.code in (404, 410):
            expected = f"the file; it may have moved, see {page}"
            return InputError("the server has no such file", where=url, got=answer, expected=expected)
        return InputError("the server refuses", where=url, got=answer)
    reason = error.reason if isinstance(error, URLError) else error
    if isinstance(reason, ssl.SSLError):
        return InputError("the server's certificate is not trusted", where=url, got=reason)
    if isinstance(reason, OSError):
        expected = "a network; without one, the files in the folder of weights"
        return InputError("no connection to the server", where=url, got=reason.strerror or reason, expected=expected)
    return InputError("the server's answer cannot be read", where=url, got=repr(reason))


class _Redirects(urllib.request.HTTPRedirectHandler):
    """Follows to trusted addresses; the token stays with the host that it was meant for."""

    def redirect_request(self, req, fp, code, msg, headers, newurl):
        if not is_trusted_url(newurl):
            raise HTTPError(req.full_url, code, f"redirected to {newurl}, which is not https", headers, fp)
        new = super().redirect_request(req, fp, code, msg, headers, newurl)
        old, target = urlsplit(req.full_url), urlsplit(newurl)
        token = req.unredirected_hdrs.get("Authorization")
        if new is not None and token and (old.scheme, old.netloc) == (target.scheme, target.netloc):
            new.add_unredirected_header("Authorization", token)
        return new
