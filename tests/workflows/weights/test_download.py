"""A download gives the complete correct file, or leaves only a part that the next one can resume."""

import errno

import pytest

from moseg.schemas.errors import InputError, StoreError
from moseg.workflows.weights.download import CHUNK_BYTES, Retries, Source, download

CONTENT = bytes(range(256)) * 4096
PATH = "/models/net.pth"
SOON = Retries(count=2, wait_sec=0.0)


def _ignore(done, total):
    pass


@pytest.fixture
def fetch(server, tmp_path, sha256):
    """Return a function that downloads the content, of known digest and size by default."""

    def fetched(url=None, report=_ignore, target=tmp_path / "net.pth", **known):
        known = {"sha256": sha256(CONTENT), "size": len(CONTENT), **known}
        return download(Source(url or server.url + PATH, **known), target, report, SOON)

    return fetched


def _files(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_good_file_arrives_whole(server, fetch, tmp_path, sha256):
    server.serve(PATH, CONTENT)
    reports = []
    found = fetch(report=lambda done, total: reports.append((done, total)))
    assert found == (sha256(CONTENT), len(CONTENT))
    assert (tmp_path / "net.pth").read_bytes() == CONTENT
    assert _files(tmp_path) == ["net.pth"]
    assert reports[0] == (0, len(CONTENT)) and reports[-1] == (len(CONTENT), len(CONTENT))


@pytest.mark.parametrize("known", [{"sha256": None, "size": None}, {"size": None}, {"sha256": None}])
def test_unknown_size_and_digest_are_returned(server, fetch, sha256, known):
    server.serve(PATH, CONTENT)
    assert fetch(**known) == (sha256(CONTENT), len(CONTENT))


def test_a_wrong_checksum_is_refused_and_nothing_is_left(server, fetch, tmp_path, sha256):
    server.serve(PATH, CONTENT[::-1])
    with pytest.raises(InputError, match=rf"got SHA-256 {sha256(CONTENT[::-1])}; expected {sha256(CONTENT)}"):
        fetch()
    assert _files(tmp_path) == []


def test_a_refused_download_leaves_the_file_that_was_there(server, fetch, tmp_path):
    (tmp_path / "net.pth").write_bytes(b"old")
    server.serve(PATH, CONTENT[::-1])
    with pytest.raises(InputError):
        fetch()
    assert (tmp_path / "net.pth").read_bytes() == b"old"


def test_a_file_of_another_size_is_not_even_downloaded(server, fetch, tmp_path):
    server.serve(PATH, CONTENT[:1000])
    with pytest.raises(InputError, match=f"got 1000 bytes; expected {len(CONTENT)} bytes"):
        fetch()
    assert _files(tmp_path) == []


def test_a_file_of_known_size_is_resumed_if_the_server_sends_no_length(server, fetch, tmp_path):
    server.serve(PATH, CONTENT, has_length=False, cuts=[70_000, 30_000])
    fetch()
    assert (tmp_path / "net.pth").read_bytes() == CONTENT
    assert server.num_sent(PATH) == len(CONTENT)


def test_a_file_of_known_size_that_stays_short_is_kept_for_the_next_download(server, fetch, tmp_path):
    server.serve(PATH, CONTENT, has_length=False, cuts=[70_000, 0, 0])
    with pytest.raises(InputError, match=f"the download was cut off.*got 70000 of {len(CONTENT)} bytes"):
        fetch()
    assert _files(tmp_path) == ["net.pth.partial"]


@pytest.mark.parametrize("headers", [{}, {"Content-Length": "-5"}])
def test_a_file_that_might_be_cut_unnoticed_is_not_downloaded(server, fetch, tmp_path, headers):
    server.serve(PATH, CONTENT, has_length=False, headers=headers, cuts=[70_000])
    with pytest.raises(InputError, match=r"does not say how long the file is in .*see https://example.org/net"):
        fetch(sha256=None, size=None, homepage="https://example.org/net")
    assert _files(tmp_path) == []


def test_a_cut_chunked_response_is_noticed(server, fetch, tmp_path, sha256):
    chunked = {"has_length": False, "headers": {"Transfer-Encoding": "chunked"}}
    whole = b"".join(b"%x\r\n%s\r\n" % (len(part), part) for part in (CONTENT[:1000], CONTENT[1000:], b""))
    server.serve(PATH, whole, cuts=[500], **chunked)
    assert fetch(sha256=None, size=None) == (sha256(CONTENT), len(CONTENT))
    assert len(server.requests) == 2


@pytest.mark.parametrize("options", [{}, {"has_length": False, "headers": {"Transfer-Encoding": "chunked"}}])
def test_an_empty_file_is_refused(server, fetch, tmp_path, options):
    server.serve(PATH, b"0\r\n\r\n" if options else b"", **options)
    with pytest.raises(InputError, match=r"the server sent an empty file in .*got 0 bytes"):
        fetch(sha256=None, size=None)
    assert _files(tmp_path) == []


def test_a_cut_connection_is_resumed_and_every_byte_requested_once(server, fetch, tmp_path):
    server.serve(PATH, CONTENT, cuts=[300_000, 500_000])
    fetch()
    assert (tmp_path / "net.pth").read_bytes() == CONTENT
    asked = [request.headers.get("range") for request in server.requests]
    assert asked == [None, "bytes=300000-", "bytes=800000-"]
    assert server.num_sent(PATH) == len(CONTENT)


def test_a_range_of_a_file_of_unknown_length_is_accepted(server, fetch, tmp_path):
    headers = {"Content-Range": f"bytes 300000-{len(CONTENT) - 1}/*"}
    server.serve(PATH, CONTENT, cuts=[300_000], headers=headers)
    fetch()
    assert (tmp_path / "net.pth").read_bytes() == CONTENT


def test_the_next_download_resumes_a_cut_one(server, fetch, tmp_path):
    server.serve(PATH, CONTENT, cuts=[300_000, 0, 0])
    with pytest.raises(
        InputError, match=f"the download was cut off in {server.url}.*got 300000 of {len(CONTENT)} bytes"
    ):
        fetch()
    assert _files(tmp_path) == ["net.pth.partial"]
    fetch()
    assert _files(tmp_path) == ["net.pth"]
    assert server.requests[-1].headers["range"] == "bytes=300000-"
    assert server.num_sent(PATH) == len(CONTENT)


def test_an_interrupted_download_is_resumed(server, fetch, tmp_path):
    server.serve(PATH, CONTENT)

    def interrupt(done, total):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fetch(report=interrupt)
    num_here = (tmp_path / "net.pth.partial").stat().st_size
    assert 0 < num_here < len(CONTENT)
    fetch()
    assert server.requests[-1].headers["range"] == f"bytes={num_here}-"
    assert (tmp_path / "net.pth").read_bytes() == CONTENT


def test_without_ranges_the_whole_file_is_requested_again(server, fetch, tmp_path):
    server.serve(PATH, CONTENT, knows_ranges=False, cuts=[300_000])
    fetch()
    assert (tmp_path / "net.pth").read_bytes() == CONTENT
    assert server.num_sent(PATH) == len(CONTENT) + 300_000


def test_retries_end_if_the_server_always_cuts_at_the_same_byte(server, fetch):
    server.serve(PATH, CONTENT, knows_ranges=False, cuts=[300_000] * 10)
    with pytest.raises(InputError, match="the download was cut off"):
        fetch()
    assert len(server.requests) == SOON.count + 1


def test_a_whole_partial_file_is_only_checked(server, fetch, tmp_path):
    server.serve(PATH, CONTENT)
    (tmp_path / "net.pth.partial").write_bytes(CONTENT)
    fetch()
    assert server.requests == []


def test_a_whole_partial_file_of_unknown_size_is_recognised(server, fetch, tmp_path):
    server.serve(PATH, CONTENT)
    (tmp_path / "net.pth.partial").write_bytes(CONTENT)
    fetch(size=None)
    assert server.num_sent(PATH) == 0
    assert (tmp_path / "net.pth").read_bytes() == CONTENT


@pytest.mark.parametrize("left", [b"x" * 1000, CONTENT + b"x", b"x" * len(CONTENT)])
@pytest.mark.parametrize("size", [len(CONTENT), None])
def test_a_damaged_partial_file_is_fetched_anew(server, fetch, tmp_path, left, size):
    server.serve(PATH, CONTENT)
    (tmp_path / "net.pth.partial").write_bytes(left)
    fetch(size=size)
    assert (tmp_path / "net.pth").read_bytes() == CONTENT


def test_parts_of_two_versions_are_never_joined(server, fetch, tmp_path, sha256):
    other = b"y" * len(CONTENT)
    server.serve(PATH, CONTENT, etag='"1"', cuts=[1000])

    def change(done, total):
        server.serve(PATH, other, etag='"2"')

    found = fetch(report=change, sha256=None, size=None)
    assert found.sha256 == sha256(other)


@pytest.mark.parametrize(
    ("other", "etag", "is_digest_known"),
    [
        (b"y" * len(CONTENT), '"2"', False),
        (b"y" * len(CONTENT), '"2"', True),
        (b"y" * len(CONTENT), None, False),
        (b"y" * (len(CONTENT) + 1), '"1"', False),
        (b"y" * 1000, '"1"', False),
    ],
)
def test_parts_are_not_joined_if_the_server_ignores_if_range(server, fetch, sha256, other, etag, is_digest_known):
    server.serve(PATH, CONTENT, etag='"1"', cuts=[1000])

    def change(done, total):
        server.serve(PATH, other, etag=etag, heeds_if_range=False)

    found = fetch(report=change, sha256=sha256(other) if is_digest_known else None, size=None)
    assert found == (sha256(other), len(other))


def test_a_part_without_a_tag_is_accepted_if_the_digest_is_known(server, fetch, sha256):
    server.serve(PATH, CONTENT, etag='"1"', cuts=[1000])

    def forget_tag(done, total):
        server.serve(PATH, CONTENT, heeds_if_range=False)

    fetch(report=forget_tag)
    assert server.num_sent(PATH) == len(CONTENT)


def test_a_part_that_ends_early_is_not_the_rest(server, fetch, sha256):
    headers = {"Content-Range": f"bytes 1000-1999/{len(CONTENT)}", "Content-Length": "1000"}
    server.serve(PATH, CONTENT, etag='"1"', cuts=[1000])

    def shorten(done, total):
        if done == 1000:
            server.serve(PATH, CONTENT, etag='"1"', headers=headers, cuts=[1000])
        elif done == 2000:
            server.serve(PATH, CONTENT, etag='"1"')

    assert fetch(report=shorten, sha256=None, size=None).sha256 == sha256(CONTENT)


def test_a_web_page_in_place_of_the_file_is_refused(server, fetch, tmp_path):
    server.serve(PATH, b"<html>Quota exceeded</html>", content_type="text/html; charset=utf-8")
    with pytest.raises(InputError, match=r"the server sent a web page.*see https://example.org/net"):
        fetch(sha256=None, size=None, homepage="https://example.org/net")
    assert _files(tmp_path) == []


def test_a_full_disk_is_noticed_before_the_download(server, fetch, tmp_path, monkeypatch):
    server.serve(PATH, CONTENT)
    usage = type("Usage", (), {"free": 1000})
    monkeypatch.setattr("moseg.workflows.weights.download.shutil.disk_usage", lambda path: usage)
    with pytest.raises(
        StoreError, match=f"no room on the disk in .*got 1000 bytes free; expected {len(CONTENT)} bytes"
    ):
        fetch()


def test_a_disk_that_fills_up_is_named(server, fetch, tmp_path, monkeypatch):
    server.serve(PATH, CONTENT)

    def fail(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("moseg.workflows.weights.download.os.fsync", fail)
    with pytest.raises(StoreError, match=r"cannot write in .*net.pth.partial; got No space left on device"):
        fetch()


def test_a_file_longer_than_it_must_be_is_not_downloaded_to_its_end(server, tmp_path, sha256):
    body = b"%x\r\n%s\r\n0\r\n\r\n" % (8 * CHUNK_BYTES, bytes(8 * CHUNK_BYTES))
    server.serve(PATH, body, has_length=False, headers={"Transfer-Encoding": "chunked"})
    reached = []
    source = Source(server.url + PATH, sha256(b""), size=1000)
    with pytest.raises(InputError, match="wrong"):
        download(source, tmp_path / "net.pth", lambda done, total: reached.append(done), Retries())
    assert max(reached) <= CHUNK_BYTES
    assert _files(tmp_path) == []
