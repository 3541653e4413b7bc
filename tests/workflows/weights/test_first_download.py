"""What nobody published a checksum of: verified against the hub's own record, or recorded once and enforced."""

import json

import pytest

from schemas.errors import InputError

COMMIT, LATER = "a" * 40, "b" * 40
TENSORS, CONFIG = b"tensors" * 1000, b'{"size": 1}'


def _pointer(digest: str, size: int) -> bytes:
    return f"version https://git-lfs.github.com/spec/v1\noid sha256:{digest}\nsize {size}\n".encode()


@pytest.fixture
def hub(server, sha256):
    """Serves the repository ``org/net`` at a commit, and says that its branch ``main`` is there."""

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
    """The item ``net`` from that repository at a revision."""

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


def test_the_hub_s_refusal_is_told(server, hub, describe_hub, open_folder):
    describe_hub("main")
    server.serve("/api/models/org/net/revision/main", b"no", status=401)
    weights = open_folder()
    with pytest.raises(InputError, match="the server gives no access"):
        weights.ensure(weights.item("net"))


@pytest.mark.parametrize("answer", [b"<html>", b"[]", b'{"sha": "main"}', b'{"sha": 3}'])
def test_an_answer_without_a_commit_is_told(server, hub, describe_hub, open_folder, answer):
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


def test_the_token_is_for_the_hub_alone():
    from workflows.weights.hub import token_for

    assert token_for("https://huggingface.co/org/net/resolve/main/model.bin", "secret") == "secret"
    for url in (
        "http://huggingface.co/net",
        "https://huggingface.co.example.org/net",
        "https://example.org/huggingface.co/net",
        "https://download.pytorch.org/models/net.pth",
    ):
        assert token_for(url, "secret") is None
