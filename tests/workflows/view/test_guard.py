"""Requests that the server refuses: without its token, from another origin, for another host, for files."""

import asyncio
import socket

import pytest

from moseg.workflows.view.server import HOST, bind


@pytest.fixture
def server(empty_server):
    return empty_server


def test_a_page_of_its_own_is_answered_with_a_strict_policy(server):
    answer = server.ask("GET", "")
    assert answer.status == 200 and b"<title>moseg view</title>" in answer.content
    policy = answer.headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; script-src 'self';") and "unsafe" not in policy
    assert answer.headers["referrer-policy"] == "no-referrer"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["cache-control"] == "no-store"


@pytest.mark.parametrize("root", ["/", "/state", "/wrong/", "/%2e%2e/", "//"])
def test_without_the_token_nothing_is_answered(server, root):
    for path in ("", "state", "main.js"):
        answer = server.ask("GET", path, root=root)
        assert answer.status == 403 and b"token" in answer.content


def test_tokens_differ(serve, tmp_path):
    roots = {serve("--out", tmp_path / "out", "--store", tmp_path / "store").root for _ in range(2)}
    assert len(roots) == 2 and min(map(len, roots)) > 30


@pytest.mark.parametrize(
    "host", ["example.org", "example.org:{port}", "127.0.0.1", "127.0.0.1:1", "[::1]:{port}", None]
)
def test_another_host_is_refused(server, host):
    host = None if host is None else host.format(port=server.port)
    answer = server.ask("GET", "state", headers={"Host": host})
    # Without a host the server itself refuses.
    assert answer.status in (400, 403) if host is None else answer.status == 403


@pytest.mark.parametrize("origin", ["http://example.org", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"])
def test_another_origin_is_refused(server, origin):
    origin = origin.format(port=server.port)
    assert server.ask("GET", "state", headers={"Origin": origin}).status == 403
    assert server.ask("POST", "undo", {"revision": 1}, headers={"Origin": origin}).status == 403


def test_a_change_without_an_origin_is_refused(server):
    assert server.ask("POST", "undo", {"revision": 1}, headers={"Origin": None}).status == 403
    assert server.ask("GET", "state", headers={"Origin": None}).status == 200


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_a_request_of_another_site_is_refused(server, site):
    assert server.ask("GET", "state", headers={"Sec-Fetch-Site": site}).status == 403


def test_a_change_must_be_json(server):
    answer = server.ask("POST", "undo", b"revision=1", headers={"Content-Type": "text/plain"})
    assert (answer.status, answer.json()["message"][:8]) == (400, "not JSON")
    assert server.ask("POST", "undo", [1]).status == 400
    assert server.ask("POST", "undo", b"{" * 100).status == 400


@pytest.mark.parametrize(
    "path",
    ["../main.js", "..%2fapplication.py", "%2e%2e/application.py", "page/main.js", "/etc/passwd", "%2fetc%2fpasswd"],
)
def test_no_path_leads_to_a_file(server, path):
    assert server.ask("GET", path).status in (404, 405)


def test_only_files_of_the_page_are_there(server):
    for name in ("main.js", "view.css", "colours.css"):
        assert server.ask("GET", name).status == 200
    for name in ("application.py", "__init__.py", "server.py", "frames/-1", "frames/0", "labels/x/0", "cues/0/0"):
        assert server.ask("GET", name).status == 404


def test_a_wrong_method_is_refused(server):
    assert server.ask("GET", "undo").status in (404, 405)
    assert server.ask("DELETE", "state").status == 405


def test_small_answers_are_sent_at_once():
    """Without TCP_NODELAY each waits 40 ms until what went before it is acknowledged."""

    async def connect() -> int:
        accepted = asyncio.get_running_loop().create_future()
        address = bind()
        server = await asyncio.start_server(lambda _, writer: accepted.set_result(writer), sock=address.socket)
        async with server:
            _, client = await asyncio.open_connection(HOST, address.port)
            writer = await accepted
            value = writer.get_extra_info("socket").getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
            for each in (writer, client):
                each.close()
                await each.wait_closed()
        return value

    assert asyncio.run(connect())
