"""What a request that failed means to the user, and what can be done about it."""

import re
import ssl
import time
from email.utils import parsedate_to_datetime
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import getproxies, proxy_bypass

from moseg.schemas.errors import InputError
from moseg.schemas.weights import LOOPBACK

FORBIDDEN, GONE, BUSY = (401, 403), (404, 410), (425, 429, 503)
PASSING = (*BUSY, 408, 500, 502, 504)
"""Answers that another try may not get."""


def explain(error: Exception, url: str, homepage: str = "") -> InputError:
    """What a failed request means to the user; `homepage` tells more about what was asked for."""
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


def asked_wait_sec(answer: HTTPError) -> float:
    """Seconds that a busy server asks to wait; 0 where it does not say."""
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
    if error.code in PASSING:
        what = "the server is busy" if error.code in BUSY else "the server fails"
        wait_sec = asked_wait_sec(error)
        expected = f"another try {f'in {wait_sec:.0f} s' if wait_sec else 'later'}"
        return InputError(what, where=url, got=got, expected=expected)
    return InputError("the server refuses", where=url, got=got)


def _proxy(url: str) -> str:
    """Host and port of the proxy through which an address is asked; empty where none is. No word of its password."""
    parts = urlsplit(url)
    proxy = getproxies().get(parts.scheme, "")
    if not proxy or parts.hostname in LOOPBACK or proxy_bypass(parts.netloc):
        return ""
    return proxy.rpartition("//")[2].rpartition("@")[2].rstrip("/")
