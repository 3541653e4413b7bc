"""Files without a published checksum: verified against the hub's record, or recorded once and enforced."""

import json
import os

import pytest

from moseg.schemas.errors import InputError

COMMIT, LATER = "a" * 40, "b" * 40
TENSORS, CONFIG = b"tensors" * 1000, b'{"size": 1}'


def _pointer(digest: str, size: int) -> bytes:
    return f"version https://git-lfs.github.com/spec/v1\noid sha256:{digest}\nsize {size}\n".encode()


@pytest.fixture
def hub(server, sha256):
    """Serve the repository ``org/net`` at a commit, to which its branch ``main`` points."""

    def publish(commit=COMMIT, tensors=TENSORS, config=CONFIG):
        for name, content in (("model.bin", tensors), ("config.json", config)):
            server.serve(f"/org/net/resolve/{commit}/{name}", content)
        server.serve(f"/org/net/raw/{commit}/model.bin", _pointer(sha256(tensors), len(tensors)))
        server.serve(f"/org/net/raw/{commit}/config.json", config)
        server.serve("/api/models/org/net/revision/main", json.dumps({"sha": commit}).encode())

    publish()
    return publish


@pytest.fixture
def describe_hub(server, describe):
    """Return a function that describes the item ``net`` from that repository at a revision."""

    def write(revision):
        base = f"{server.url}/org/net/resolve/{revision}"
        files = [{"name": name, "url": f"{base}/{name}"} for name in ("config.json", "model.bin")]
        describe({"architecture": "dpt_dinov2", "files": files})

    return write


def _paths(server):
    return [request.path for request in server.requests]


def test_a_file_of_a_commit_is_checked_against_its_record(server, hub, describe_hub, open_folder, folder, sha256):
    describe_hub(COMMIT)
    weights = open_folder()
    weights.ensure(weights.item("net"))
    assert (folder / "net" / "model.bin").read_bytes() == TENSORS
    assert weights.digests(weights.item("net"))["model.bin"] == sha256(TENSORS)
    assert not any("/api/" in path for path in _paths(server))


def test_bytes_that_are_not_those_of_the_record_are_refused(server, hub, describe_hub, open_folder, folder):
    describe_hub(COMMIT)
    server.serve(f"/org/net/resolve/{COMMIT}/model.bin", TENSORS[::-1])
    weights = open_folder()
    with pytest.raises(InputError, match="a wrong file was downloaded"):
        weights.ensure(weights.item("net"))
    assert not list((folder / "net").glob("model.bin*"))


def test_a_branch_is_resolved_once_and_kept(server, hub, describe_hub, open_folder, folder, capsys):
    describe_hub("main")
    weights = open_folder()
    weights.ensure(weights.item("net"))
    note = capsys.readouterr().err
    assert note.startswith("note: no version of net/config.json is pinned") and COMMIT in note
    assert len(note.splitlines()) == 1
    hub(LATER, tensors=b"later", config=b"{}")
    (folder / "net" / "model.bin").unlink()
    weights.ensure(weights.item("net"))
    assert (folder / "net" / "model.bin").read_bytes() == TENSORS
    assert _paths(server).count("/api/models/org/net/revision/main") == 1
    assert capsys.readouterr().err == ""


def test_a_small_file_is_recorded_and_enforced(server, hub, describe_hub, open_folder, folder, sha256):
    describe_hub(COMMIT)
    weights = open_folder()
    item = weights.item("net")
    before = weights.digests(item)
    (folder / "net" / "config.json").write_bytes(b'{"size": 2}')
    assert weights.digests(item) == before
    assert [verdict.is_wrong for verdict in weights.verify(item)] == [True, False]
    server.serve(f"/org/net/resolve/{COMMIT}/config.json", b'{"size": 3}')
    with pytest.raises(InputError, match="a wrong file was downloaded"):
        weights.repair(item)


def test_a_later_revision_of_the_item_is_fetched_anew(hub, describe_hub, open_folder, folder):
    describe_hub(COMMIT)
    open_folder().ensure(open_folder().item("net"))
    hub(LATER, tensors=b"later", config=b'{"size": 2}')
    describe_hub(LATER)
    weights = open_folder()
    assert not weights.is_present(weights.item("net"))
    weights.ensure(weights.item("net"))
    assert (folder / "net" / "model.bin").read_bytes() == b"later"
    assert weights.is_present(weights.item("net"))


def test_an_address_elsewhere_is_recorded_and_enforced(server, describe, open_folder, folder, sha256, capsys):
    describe({"files": [{"name": "model.pth", "url": server.serve("/net.pth", TENSORS)}]})
    weights = open_folder(quiet=True)
    item = weights.item("net")
    assert weights.digests(item) == {"model.pth": sha256(TENSORS)}
    assert "note: no checksum of net/model.pth is published" in capsys.readouterr().err
    (folder / "net" / "model.pth").unlink()
    server.serve("/net.pth", TENSORS[::-1])
    with pytest.raises(InputError, match="a wrong file was downloaded"):
        weights.ensure(item)


@pytest.mark.parametrize("is_renamed", [True, False])
def test_a_download_that_is_killed_as_it_ends_is_recorded(
    server, describe, open_folder, folder, sha256, monkeypatch, is_renamed
):
    describe({"files": [{"name": "model.pth", "url": server.serve("/net.pth", TENSORS)}]})
    weights = open_folder()
    item, path, rename = weights.item("net"), folder / "net" / "model.pth", os.replace

    def die(source, target):
        if target != path or is_renamed:
            rename(source, target)
        if target == path:
            raise KeyboardInterrupt

    with monkeypatch.context() as killed:
        killed.setattr(os, "replace", die)
        with pytest.raises(KeyboardInterrupt):
            weights.ensure(item)
    assert path.exists() == is_renamed
    weights.ensure(item)
    assert server.num_sent("/net.pth") == len(TENSORS)
    path.write_bytes(TENSORS[::-1])
    assert weights.digests(item) == {"model.pth": sha256(TENSORS)}
    assert [verdict.is_wrong for verdict in weights.verify(item)] == [True]


@pytest.fixture
def bad_first(server, describe, folder):
    """Return a function that fetches ``net`` while its address serves half a file; it serves the whole one then."""

    def fetched(weights):
        (folder / "net" / "model.pth").unlink(missing_ok=True)
        server.serve("/net.pth", b"half a file")
        weights.ensure(weights.item("net"))
        server.serve("/net.pth", TENSORS)

    describe({"files": [{"name": "model.pth", "url": f"{server.url}/net.pth"}]})
    return fetched


def test_a_bad_first_download_says_how_to_get_it_anew(bad_first, open_folder):
    weights = open_folder()
    bad_first(weights)
    item = weights.item("net")
    with pytest.raises(InputError, match=r"unreadable weights in .*; `moseg weights fetch net --again` gets it anew"):
        weights.read(item, weights.digests(item))


def test_a_bad_first_download_can_be_replaced(bad_first, open_folder, sha256):
    weights = open_folder()
    bad_first(weights)
    item = weights.item("net")
    weights.repair(item)
    assert weights.digests(item) == {"model.pth": sha256(b"half a file")}
    weights.repair(item, again=True)
    assert weights.digests(item) == {"model.pth": sha256(TENSORS)}
    assert not any(verdict.is_wrong for verdict in weights.verify(item))


def test_a_failed_second_download_keeps_the_first_file(bad_first, server, open_folder, folder, sha256):
    weights = open_folder()
    bad_first(weights)
    del server.answers["/net.pth"]
    with pytest.raises(InputError, match="no such file"):
        weights.repair(weights.item("net"), again=True)
    assert weights.digests(weights.item("net")) == {"model.pth": sha256(b"half a file")}
    assert (folder / "net" / "model.pth").read_bytes() == b"half a file"


def test_again_needs_a_network(bad_first, server, open_folder):
    bad_first(open_folder())
    num_requests = len(server.requests)
    weights = open_folder(offline=True)
    with pytest.raises(InputError, match=r"no network is to be used .*`moseg weights fetch net --again`"):
        weights.repair(weights.item("net"), again=True)
    assert len(server.requests) == num_requests


def test_again_keeps_files_that_match_the_hub_s_record(server, hub, describe_hub, open_folder, folder):
    describe_hub("main")
    weights = open_folder()
    weights.ensure(weights.item("net"))
    hub(LATER, tensors=b"later", config=b"{}")
    before = (folder / "net" / "pins.json").read_bytes()
    weights.repair(weights.item("net"), again=True)
    assert _paths(server).count(f"/org/net/resolve/{COMMIT}/model.bin") == 1
    assert _paths(server).count(f"/org/net/resolve/{COMMIT}/config.json") == 2
    assert (folder / "net" / "pins.json").read_bytes() == before


def test_a_refusal_of_the_hub_is_reported(server, hub, describe_hub, open_folder):
    describe_hub("main")
    server.serve("/api/models/org/net/revision/main", b"no", status=401)
    weights = open_folder()
    with pytest.raises(InputError, match="the server gives no access"):
        weights.ensure(weights.item("net"))


@pytest.mark.parametrize("answer", [b"<html>", b"[]", b'{"sha": "main"}', b'{"sha": 3}'])
def test_an_answer_without_a_commit_is_reported(server, hub, describe_hub, open_folder, answer):
    describe_hub("main")
    server.serve("/api/models/org/net/revision/main", answer)
    weights = open_folder()
    with pytest.raises(InputError, match="the hub names no commit"):
        weights.ensure(weights.item("net"))


def test_unreadable_pins_are_named(hub, describe_hub, open_folder, folder):
    describe_hub(COMMIT)
    (folder / "net").mkdir()
    (folder / "net" / "pins.json").write_text("{")
    weights = open_folder()
    with pytest.raises(InputError, match=r"unreadable pins in .*pins.json"):
        weights.ensure(weights.item("net"))


def test_a_busy_hub_is_reported_as_busy(server, hub, describe_hub, open_folder):
    describe_hub("main")
    server.serve("/api/models/org/net/revision/main", b"", status=429, headers={"Retry-After": "300"})
    weights = open_folder()
    with pytest.raises(InputError, match=r"the server is busy in .*expected another try in 300 s"):
        weights.ensure(weights.item("net"))


def test_a_pin_of_an_empty_file_is_refused(describe, open_folder, folder, server):
    describe({"files": [{"name": "model.pth", "url": f"{server.url}/net.pth"}]})
    (folder / "net").mkdir()
    pin = {"source": f"{server.url}/net.pth", "sha256": "0" * 64, "size": 0}
    (folder / "net" / "pins.json").write_text(json.dumps({"files": {"model.pth": pin}}))
    with pytest.raises(InputError, match="unreadable pins"):
        open_folder().ensure(open_folder().item("net"))


@pytest.mark.parametrize("token", ["hf_secret\nX-Header: x", "hf_sécret", "hf secret", "hf_secret\x00"])
def test_an_invalid_token_is_refused_and_not_printed(token):
    from moseg.workflows.weights.hub import token_for

    assert token_for("https://example.org/net", token) is None
    with pytest.raises(InputError, match="not a token in HF_TOKEN") as refused:
        token_for("https://huggingface.co/org/net/resolve/main/model.bin", token)
    assert "cret" not in str(refused.value)


def test_blanks_around_a_token_are_removed(server, hub, describe_hub, open_folder, monkeypatch):
    monkeypatch.setattr("moseg.workflows.weights.hub.token_for", lambda url, token: token)
    describe_hub("main")
    weights = open_folder(HF_TOKEN=" hf_secret\n")
    weights.ensure(weights.item("net"))
    assert server.requests[0].headers["authorization"] == "Bearer hf_secret"


def test_the_token_is_sent_to_the_hub_only():
    from moseg.workflows.weights.hub import token_for

    assert token_for("https://huggingface.co/org/net/resolve/main/model.bin", "secret") == "secret"
    for url in (
        "http://huggingface.co/net",
        "https://huggingface.co.example.org/net",
        "https://example.org/huggingface.co/net",
        "https://download.pytorch.org/models/net.pth",
    ):
        assert token_for(url, "secret") is None
