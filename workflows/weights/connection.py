"""Asking a server: over https only, and with a token that no other host sees."""

import urllib.request
from collections.abc import Mapping
from http.client import HTTPException, HTTPResponse, InvalidURL
from urllib.error import HTTPError
from urllib.parse import urlsplit

from moseg.schemas.weights import LOOPBACK, is_trusted_url
from moseg.workflows.weights.refusals import explain

TIMEOUT_SEC = 30.0
"""Longest silence of a server that is waited for."""
USER_AGENT = "moseg"


def open_url(url: str, headers: Mapping[str, str], token: str | None) -> HTTPResponse:
    """The answer to a GET; raises as `urllib.request` does (HTTPError, URLError), or HTTPException."""
    request = urllib.request.Request(url, headers={"User-Agent": USER_AGENT, **headers})
    if token:
        request.add_unredirected_header("Authorization", f"Bearer {token}")
    # A proxy is for what lies outside.
    local = [urllib.request.ProxyHandler({})] if urlsplit(url).hostname in LOOPBACK else []
    try:
        return urllib.request.build_opener(_Redirects, *local).open(request, timeout=TIMEOUT_SEC)
    # An address that is none, of a redirect or of a proxy: it is parsed in many places, each with an error of its own.
    except ValueError as error:
        raise InvalidURL(str(error)) from error


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


def _is_loopback(url: str) -> bool:
    return urlsplit(url).hostname in LOOPBACK


class _Redirects(urllib.request.HTTPRedirectHandler):
    """Follows to trusted addresses; the token stays with the host that it was meant for."""

    def redirect_request(self, req, fp, code, msg, headers, newurl):
        if not is_trusted_url(newurl) or (_is_loopback(newurl) and not _is_loopback(req.full_url)):
            raise HTTPError(req.full_url, code, f"redirected to {newurl}, which is no https address", headers, fp)
        new = super().redirect_request(req, fp, code, msg, headers, newurl)
        old, target = urlsplit(req.full_url), urlsplit(newurl)
        token = req.unredirected_hdrs.get("Authorization")
        if new is not None and token and (old.scheme, old.netloc) == (target.scheme, target.netloc):
            new.add_unredirected_header("Authorization", token)
        return new
