"""The folder of weights: fetched once, offline when asked, wrong files refused, own items beside the catalogue's."""

import errno
import json
import os
import re
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.weights.fetch_command import fetch_command
from moseg.workflows.weights.folder import Weights

CONTENT = b"weights" * 10_000
SEQUENCE = "pan"
FETCH = """
import sys
from moseg.workflows.weights.folder import open_weights
weights = open_weights({"MOSEG_WEIGHTS": sys.argv[1]})
weights.ensure(weights.item("net"))
"""


@pytest.fixture
def known(server, describe, sha256):
    """Describe the item ``net`` with one file of known size and digest, which the server has."""
    url = server.serve("/net.pth", CONTENT)
    describe({"files": [{"name": "model.pth", "url": url, "size": len(CONTENT), "sha256": sha256(CONTENT)}]})


def test_the_folder_is_where_the_environment_says(tmp_path):
    from moseg.workflows.weights.own_items import weights_folder

    home = {"HOME": "/home/someone"}
    assert weights_folder(home) == Path("/home/someone/.cache/moseg/weights")
    assert weights_folder({**home, "XDG_CACHE_HOME": "/cache"}) == Path("/cache/moseg/weights")
    assert weights_folder({**home, "XDG_CACHE_HOME": "/cache", "MOSEG_WEIGHTS": "/w"}) == Path("/w")


def test_weights_are_fetched_once(known, server, open_folder, folder):
    weights = open_folder()
    item = weights.item("net")
    assert not weights.is_present(item)
    weights.ensure(item)
    assert weights.is_present(item)
    assert (folder / "net" / "model.pth").read_bytes() == CONTENT
    open_folder().ensure(item)
    assert len(server.requests) == 1


def test_pinned_digests_need_no_file(known, server, open_folder, sha256):
    weights = open_folder(offline=True)
    assert weights.digests(weights.item("net")) == {"model.pth": sha256(CONTENT)}
    assert server.requests == []


@pytest.mark.parametrize("how", [{"offline": True}, {"MOSEG_OFFLINE": "1"}])
def test_offline_names_the_missing_file_and_the_command(known, server, open_folder, folder, how):
    weights = open_folder(**how)
    with pytest.raises(MissingInputError) as refused:
        weights.ensure(weights.item("net"))
    assert str(refused.value) == (
        f"weights net are not here in {folder}/net/model.pth; expected `moseg weights fetch net`, with a network"
    )
    assert server.requests == []


def test_offline_uses_files_that_are_here(known, open_folder):
    open_folder().ensure(open_folder().item("net"))
    weights = open_folder(MOSEG_OFFLINE="1")
    weights.ensure(weights.item("net"))


def test_a_tampered_file_is_refused_and_never_served_again(known, open_folder, folder, sha256):
    weights = open_folder()
    item = weights.item("net")
    weights.ensure(item)
    path, tampered = folder / "net" / "model.pth", CONTENT[:-1] + b"x"
    path.write_bytes(tampered)
    digests = weights.digests(item)
    with pytest.raises(InputError) as refused:
        weights.read(item, digests)
    assert str(refused.value) == (
        f"a wrong weights file in {path}; got SHA-256 {sha256(tampered)}; expected {sha256(CONTENT)};"
        " it is renamed to model.pth.refused, `moseg weights fetch net` gets the right one"
    )
    assert sorted(entry.name for entry in path.parent.glob("model*")) == ["model.pth.refused"]
    with pytest.raises(MissingInputError):
        weights.read(item, digests)
    weights.ensure(item)
    assert path.read_bytes() == CONTENT


def test_a_truncated_file_in_the_folder_is_refused_by_its_size(known, open_folder, folder):
    (folder / "net").mkdir()
    (folder / "net" / "model.pth").write_bytes(CONTENT[:100])
    weights = open_folder(offline=True)
    with pytest.raises(
        InputError, match=f"a wrong weights file in .*got 100 bytes; expected {len(CONTENT)} bytes; it is"
    ):
        weights.ensure(weights.item("net"))
    assert not (folder / "net" / "model.pth").exists()


def test_repair_replaces_only_what_is_wrong(known, server, open_folder, folder):
    weights = open_folder()
    item = weights.item("net")
    weights.repair(item)
    weights.repair(item)
    assert len(server.requests) == 1
    (folder / "net" / "model.pth").write_bytes(CONTENT[::-1])
    weights.repair(item)
    assert len(server.requests) == 2
    assert (folder / "net" / "model.pth").read_bytes() == CONTENT


def test_non_commercial_weights_need_consent(server, describe, open_folder):
    file = {"name": "model.pth", "url": server.serve("/net.pth", CONTENT)}
    describe({"licence": "CC-BY-NC-4.0", "is_non_commercial": True, "files": [file]})
    weights = open_folder()
    line = "weights for non-commercial use only in net; got licence CC-BY-NC-4.0; expected --non-commercial"
    for use in (weights.ensure, weights.digests, weights.repair):
        with pytest.raises(InputError, match=line):
            use(weights.item("net"))
    assert server.requests == []
    for opened in (open_folder(allow_non_commercial=True), open_folder(MOSEG_NON_COMMERCIAL="1")):
        opened.ensure(opened.item("net"))


CONDITIONS = {"licence": "SAM-License", "has_conditions": True, "homepage": "https://example.org/net"}


def test_a_licence_with_conditions_is_accepted_by_its_name(server, describe, open_folder):
    describe({**CONDITIONS, "files": [{"name": "model.pth", "url": server.serve("/net.pth", CONTENT)}]})
    line = (
        "weights whose licence has conditions in net; got licence SAM-License; expected --accept-licence SAM-License, "
        "or MOSEG_ACCEPT_LICENCE=SAM-License, once you agree to it: see https://example.org/net"
    )
    for opened in (
        open_folder(),
        open_folder(allow_non_commercial=True),
        open_folder(accept_licence="Other, SAM"),
        open_folder(MOSEG_ACCEPT_LICENCE="1"),
    ):
        for use in (opened.ensure, opened.digests, opened.repair):
            with pytest.raises(InputError, match=re.escape(line)):
                use(opened.item("net"))
    assert server.requests == []
    for opened in (
        open_folder(accept_licence="other, sam-license"),
        open_folder(MOSEG_ACCEPT_LICENCE="SAM-License"),
        open_folder(check_licences=False),
    ):
        opened.ensure(opened.item("net"))


def test_own_files_may_change_between_runs(describe, open_folder, folder, sha256):
    describe({"files": [{"name": "model.pth"}]})
    (folder / "net").mkdir()
    path = folder / "net" / "model.pth"
    weights = open_folder(offline=True)
    item = weights.item("net")
    for content in (CONTENT, CONTENT[::-1]):
        path.write_bytes(content)
        os.utime(path, ns=(0, len(content) + content[0]))
        weights.ensure(item)
        assert weights.digests(item) == {"model.pth": sha256(content)}


def test_an_own_file_that_changed_during_the_run_is_refused_and_kept(describe, open_folder, folder):
    describe({"files": [{"name": "model.pth"}]})
    (folder / "net").mkdir()
    path = folder / "net" / "model.pth"
    path.write_bytes(CONTENT)
    weights = open_folder()
    digests = weights.digests(weights.item("net"))
    path.write_bytes(CONTENT[::-1])
    with pytest.raises(InputError, match=f"another weights file in {path}; .* as when the run began"):
        weights.read(weights.item("net"), digests)
    assert path.read_bytes() == CONTENT[::-1]


def test_a_missing_own_file_is_named(describe, open_folder, folder):
    describe({"files": [{"name": "model.pth"}]})
    weights = open_folder()
    with pytest.raises(MissingInputError, match=f"{folder}/net/model.pth; expected your file"):
        weights.digests(weights.item("net"))


def test_own_items_take_the_place_of_the_catalogue_s(describe, open_folder):
    catalogue = open_folder().items
    describe({"name": "raft-large", "files": [{"name": "model.pth"}]}, {"files": [{"name": "model.pth"}]})
    items = open_folder().items
    assert set(items) == {*catalogue, "net"}
    assert items["raft-large"].files[0].url is None


def test_a_misspelt_item_gets_the_nearest_name(open_folder):
    with pytest.raises(InputError, match=r"unknown weights item 'raft_large' in .*: did you mean 'raft-large'\?"):
        open_folder().item("raft_large")


@pytest.mark.parametrize("name", ["..", "../net", "a/b", "a\\b", "/etc", ".hidden", "", "net\n", "x" * 200])
@pytest.mark.parametrize("where", ["item", "file"])
def test_names_cannot_leave_the_folder(describe, open_folder, folder, name, where):
    item = {"name": name, "files": [{"name": "model.pth"}]}
    if where == "file":
        item = {"files": [{"name": f"{name}/model.pth" if name else ""}]}
    describe(item)
    with pytest.raises(InputError, match=f"bad weights item in {folder}/weights.json at items.0"):
        open_folder().item("net")


@pytest.mark.parametrize(
    ("item", "expected"),
    [
        ({"files": [{"name": "model.pth", "url": "http://example.org/net.pth"}]}, "an https:// address"),
        ({"files": [{"name": "model.pth", "url": "file:///etc/passwd"}]}, "an https:// address"),
        ({"files": [{"name": "model.pth", "sha256": "abc"}]}, "pattern"),
        ({"files": [{"name": "model.pth", "size": 0}]}, "greater than or equal to 1"),
        ({"files": [{"name": "model.pth"}, {"name": "other.pth"}]}, "exactly one"),
        ({"files": [{"name": "model.pth"}, {"name": "pins.json"}]}, "does not use itself"),
        ({"files": [{"name": "model.pth"}, {"name": "x.partial"}]}, "does not use itself"),
        ({"architecture": "sam2", "files": [{"name": "model.safetensors"}]}, "include config.json"),
        ({"architecture": "yolo", "files": [{"name": "model.pth"}]}, "'raft'"),
        ({"files": [{"name": "model.pth"}], "licens": "MIT"}, "Extra inputs"),
    ],
)
def test_an_invalid_item_is_refused_with_its_place(describe, open_folder, item, expected):
    describe(item)
    with pytest.raises(InputError, match=rf"weights.json at items.0.*{expected}"):
        open_folder().item("net")


def test_a_run_without_weights_does_not_read_the_list(folder, moseg, monkeypatch, in_empty_folder):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(folder))
    folder.mkdir()
    (folder / "weights.json").write_text("{")
    assert moseg("plan", "--sequences", SEQUENCE).code == 0
    refused = moseg("plan", "--sequences", SEQUENCE, "--flow", "raft")
    assert refused.code == 2 and "weights.json at JSON" in refused.err


def test_given_items_replace_all_others(folder):
    folder.mkdir()
    (folder / "weights.json").write_text("{")
    assert list(Weights(folder, {}).items) == []


@pytest.mark.parametrize("use", [Weights.digests, Weights.verify])
def test_a_file_that_cannot_be_read_is_named(describe, open_folder, folder, monkeypatch, use):
    describe({"files": [{"name": "model.pth"}]})
    (folder / "net").mkdir()
    (folder / "net" / "model.pth").write_bytes(CONTENT)
    weights = open_folder()
    item = weights.item("net")

    # Permissions do not hold for everyone who runs this.
    def refuse(*arguments):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("moseg.workflows.weights.pins.open", refuse, raising=False)
    line = f"unreadable weights file in {folder}/net/model.pth; got Permission denied"
    with pytest.raises(InputError, match=line):
        use(weights, item)


@pytest.mark.parametrize("url", ["https://localhost/é.pth", "https://a..b/x", "https://a b/x", "https://a.org:zz/x"])
def test_a_malformed_address_is_refused(describe, open_folder, url):
    describe({"files": [{"name": "model.pth", "url": url}]})
    with pytest.raises(InputError, match=r"weights.json at items.0.files.0.url.*expected an https://.*printable ASCII"):
        open_folder().item("net")


def test_a_config_that_has_no_digest_is_refused_with_its_place(folder, open_folder):
    folder.mkdir()
    item = {"name": "net", "architecture": "raft", "files": [{"name": "model.pth"}], "config": {"a": float("nan")}}
    (folder / "weights.json").write_text(json.dumps({"items": [item]}))
    with pytest.raises(InputError, match=r"weights.json at items.0.config.*nan cannot be hashed"):
        open_folder().item("net")


def test_a_command_gets_several_items(describe, open_folder):
    files = [{"name": "model.pth"}]
    describe({"name": "a", "files": files}, {"name": "b", "files": files, "is_non_commercial": True})
    a, b = (open_folder().item(name) for name in "ab")
    assert fetch_command(a) == "moseg weights fetch a"
    assert fetch_command(a, b) == "moseg weights fetch a b --non-commercial"
    assert fetch_command(b, again=True) == "moseg weights fetch b --non-commercial --again"
    describe({"name": "a", "files": files}, *({"name": name, "files": files, **CONDITIONS} for name in "bc"))
    a, b, c = (open_folder().item(name) for name in "abc")
    assert fetch_command(a, b, c) == "moseg weights fetch a b c --accept-licence SAM-License"


def test_a_list_that_is_not_json_is_refused(folder, open_folder):
    folder.mkdir()
    (folder / "weights.json").write_text("items: []")
    with pytest.raises(InputError, match=r"weights.json at JSON"):
        open_folder().item("net")


def test_two_items_of_one_name_are_refused(describe, open_folder):
    describe(*[{"files": [{"name": "model.pth"}]}] * 2)
    with pytest.raises(InputError, match="items of different names"):
        open_folder().item("net")


def test_a_folder_that_cannot_be_written_is_named(known, folder, open_folder):
    (folder / "net").write_text("a file in its place")
    weights = open_folder()
    with pytest.raises(InputError, match=f"cannot write in {folder}/net"):
        weights.ensure(weights.item("net"))


@pytest.fixture
def start_fetch(folder):
    """Return a function that starts a process that fetches ``net``."""

    def start():
        return subprocess.Popen([sys.executable, "-c", FETCH, str(folder)], stderr=subprocess.PIPE, text=True)

    return start


def test_two_processes_fetch_a_file_once(known, server, folder, start_fetch):
    server.answers["/net.pth"].gate = threading.Event()
    with start_fetch() as first:
        assert server.arrived.wait(600)
        with start_fetch() as second:
            assert second.stderr.readline() == "net: waiting for another process that fetches it\n"
            server.answers["/net.pth"].gate.set()
            assert (first.wait(600), second.wait(600)) == (0, 0)
    assert len(server.requests) == 1
    assert (folder / "net" / "model.pth").read_bytes() == CONTENT


def test_a_killed_download_releases_its_lock(known, server, folder, start_fetch, open_folder):
    server.answers["/net.pth"].gate = threading.Event()
    with start_fetch() as killed:
        assert server.arrived.wait(600)
        killed.kill()
    server.answers["/net.pth"].gate.set()
    weights = open_folder()
    weights.ensure(weights.item("net"))
    assert (folder / "net" / "model.pth").read_bytes() == CONTENT


def test_progress_is_plain_lines_without_a_terminal_and_none_when_quiet(known, open_folder, folder, capsys):
    weights = open_folder(quiet=False)
    weights.ensure(weights.item("net"))
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "fetching net/model.pth from 127.0.0.1"
    assert lines[-1].startswith("net/model.pth: 70 kB in ")
    (folder / "net" / "model.pth").unlink()
    open_folder(quiet=True).ensure(weights.item("net"))
    assert capsys.readouterr().err == ""


def test_the_folder_can_be_sent_to_workers(known, open_folder):
    import cloudpickle

    weights = open_folder()
    assert cloudpickle.loads(cloudpickle.dumps(weights)).item("net") == weights.item("net")


def test_the_documented_example_is_a_valid_item(folder, open_folder):
    folder.mkdir()
    item = {"name": "my-raft", "architecture": "raft", "licence": "MIT", "files": [{"name": "model.pth"}]}
    (folder / "weights.json").write_text(json.dumps({"items": [item]}))
    assert open_folder().item("my-raft").licence == "MIT"
