"""A server that refuses, is busy or leads elsewhere: what is asked of it, and what the user is told."""

import socket
import urllib.request
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from urllib.error import HTTPError

import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.weights.connection import _Redirects
from moseg.workflows.weights.download import Retries, Source, download

CONTENT = b"weights"
PATH = "/models/net.pth"
SOON = Retries(count=2, wait_sec=0.0)


@pytest.fixture
def fetch(server, tmp_path, sha256):
    """Return a function that downloads the content, of known digest and size."""

    def fetched(url=None, **options):
        source = Source(url or server.url + PATH, sha256(CONTENT), len(CONTENT), **options)
        return download(source, tmp_path / "net.pth", lambda done, total: None, SOON)

    return fetched


@pytest.mark.parametrize(
    ("status", "line"), [(500, "the server fails in"), (503, "the server is busy in"), (429, "the server is busy in")]
)
def test_a_busy_server_is_retried(server, fetch, status, line):
    server.serve(PATH, b"", status=status)
    with pytest.raises(InputError, match=rf"{line} {server.url}.*got {status} .*; expected another try later"):
        fetch()
    assert len(server.requests) == SOON.count + 1


def test_the_wait_that_a_busy_server_asks_for_is_kept(server, fetch, no_waiting):
    server.serve(PATH, b"", status=429, headers={"Retry-After": "7"})
    with pytest.raises(InputError, match=r"the server is busy in .*expected another try in 7 s"):
        fetch()
    assert no_waiting == [7.0] * SOON.count


@pytest.mark.parametrize("is_date", [False, True])
def test_a_long_wait_ends_the_download(server, fetch, no_waiting, is_date):
    in_an_hour = format_datetime(datetime.now(UTC) + timedelta(hours=1), usegmt=True)
    asked = in_an_hour if is_date else "3600"
    server.serve(PATH, b"", status=429, headers={"Retry-After": asked})
    with pytest.raises(InputError, match=r"the server is busy in .*expected another try in 3[56]\d\d s"):
        fetch()
    assert (len(server.requests), no_waiting) == (1, [])


@pytest.mark.parametrize("asked", ["soon", "-3", "Mon, 01 Jan 2001 00:00:00 GMT"])
def test_a_senseless_wait_is_ignored(server, fetch, no_waiting, asked):
    server.serve(PATH, b"", status=503, headers={"Retry-After": asked})
    with pytest.raises(InputError, match="expected another try later"):
        fetch()
    assert no_waiting == [0.0] * SOON.count


@pytest.mark.parametrize(
    ("status", "line"),
    [
        (401, "the server gives no access in .*got 401 .*expected access: see https://example.org/net; .*HF_TOKEN"),
        (403, "the server gives no access in .*got 403 "),
        (404, "the server has no such file in .*got 404 .*see https://example.org/net"),
        (400, "the server refuses in .*got 400 "),
    ],
)
def test_a_refusal_says_what_to_do_and_is_final(server, fetch, tmp_path, status, line):
    server.serve(PATH, b"no", status=status)
    with pytest.raises(InputError, match=line):
        fetch(homepage="https://example.org/net")
    assert len(server.requests) == 1
    assert not any(tmp_path.iterdir())


def test_without_a_network_the_address_is_named(fetch, tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(
        InputError, match=rf"no connection to the server in http://127.0.0.1:{port}/net; got Connection refused"
    ):
        fetch(url=f"http://127.0.0.1:{port}/net")
    assert not any(tmp_path.iterdir())


def test_a_redirect_to_an_unprotected_address_is_not_followed(server, fetch):
    server.serve(PATH, b"", location="http://example.org/net.pth")
    with pytest.raises(InputError, match=r"redirected to http://example.org/net.pth, which is no https address"):
        fetch()


@pytest.mark.parametrize(
    "location", ["https://a..b/x", "https://exa mple.org/x", "https://a.org:zz/x", "https://[a/x", "https://é.org/x"]
)
def test_a_redirect_to_a_malformed_address_is_refused(server, fetch, tmp_path, location):
    server.serve(PATH, b"", location=location)
    with pytest.raises(InputError, match=server.url):
        fetch()
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("proxy", ["127.0.0.1:{port}", "http://me:secret@127.0.0.1:{port}/", "http://a..b:{port}"])
def test_a_proxy_that_fails_is_named_without_its_password(fetch, monkeypatch, proxy):
    for variable in ("no_proxy", "NO_PROXY", "HTTPS_PROXY"):
        monkeypatch.delenv(variable, raising=False)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    monkeypatch.setenv("https_proxy", proxy.format(port=port))
    with pytest.raises(
        InputError, match=rf"no connection through the proxy .*answers at \S+:{port}, .*https_proxy"
    ) as (refused):
        fetch(url="https://example.org/net.pth")
    assert "secret" not in str(refused.value)


def test_a_token_stays_with_its_host(server, fetch):
    away = server.url.replace("127.0.0.1", "localhost") + "/there"
    server.serve(PATH, b"", location="/here")
    server.serve("/here", b"", location=away)
    server.serve("/there", CONTENT)
    fetch(token="secret")
    assert [request.headers.get("authorization") for request in server.requests] == ["Bearer secret"] * 2 + [None]


def test_another_host_cannot_redirect_to_this_machine():
    redirects = _Redirects()
    for origin, is_followed in (("https://example.org/net.pth", False), ("http://127.0.0.1:9/net.pth", True)):
        request = urllib.request.Request(origin)
        answer = (request, None, 302, "Found", {}, "http://127.0.0.1:8/x")
        if is_followed:
            assert redirects.redirect_request(*answer).full_url == "http://127.0.0.1:8/x"
        else:
            with pytest.raises(HTTPError, match=r"127\.0\.0\.1"):
                redirects.redirect_request(*answer)
