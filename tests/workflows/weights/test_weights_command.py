"""`moseg weights`: fetch, verify, tiny; one line and exit code 2 on failure."""

import json

import pytest

from moseg.schemas.declared_names import declared_names

CONTENT = b"weights" * 1000

pytestmark = pytest.mark.usefixtures("in_empty_folder", "no_waiting")


@pytest.fixture
def net(server, describe, folder, sha256, monkeypatch):
    """Describe the item ``net``, which the server has, in the folder that the environment names."""
    for variable in ("MOSEG_OFFLINE", "MOSEG_NON_COMMERCIAL", "MOSEG_ACCEPT_LICENCE", "HF_TOKEN"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("MOSEG_WEIGHTS", str(folder))
    url = server.serve("/net.pth", CONTENT)
    describe({"files": [{"name": "model.pth", "url": url, "size": len(CONTENT), "sha256": sha256(CONTENT)}]})
    return folder / "net" / "model.pth"


def test_fetch_gets_an_item_and_prints_its_folder(net, moseg):
    ran = moseg("weights", "fetch", "net", "--quiet")
    assert (ran.code, ran.out, ran.err) == (0, f"net: {net.parent}\n", "")
    assert net.read_bytes() == CONTENT


def test_fetch_replaces_a_damaged_file(net, moseg):
    moseg("weights", "fetch", "net")
    net.write_bytes(CONTENT[::-1])
    assert moseg("weights", "fetch", "net").code == 0
    assert net.read_bytes() == CONTENT


def test_fetch_ignores_moseg_offline(net, moseg, monkeypatch):
    monkeypatch.setenv("MOSEG_OFFLINE", "1")
    assert moseg("weights", "fetch", "net").code == 0


def test_a_cut_connection_does_not_stop_it(net, server, moseg):
    server.answers["/net.pth"].cuts = [2000, 1000]
    assert moseg("weights", "fetch", "net").code == 0
    assert net.read_bytes() == CONTENT
    assert server.num_sent("/net.pth") == len(CONTENT)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"content": CONTENT[::-1]}, "moseg: a wrong file was downloaded in "),
        ({"content": CONTENT[:9]}, "moseg: a wrong file is offered in "),
        ({"status": 401}, "moseg: the server gives no access in "),
        ({"status": 404}, "moseg: the server has no such file in "),
        ({"cuts": [0] * 20}, "moseg: the download was cut off in "),
    ],
)
def test_a_failed_fetch_is_one_line_and_exit_code_two(net, server, moseg, change, line):
    for name, value in change.items():
        setattr(server.answers["/net.pth"], name, value)
    ran = moseg("weights", "fetch", "net", "--quiet")
    assert ran.code == 2
    assert ran.err.startswith(line) and len(ran.err.splitlines()) == 1
    assert not net.exists()


def test_a_misspelt_preset_gets_the_nearest_name(net, moseg):
    ran = moseg("weights", "fetch", "--preset", "papr")
    assert (ran.code, ran.err) == (2, "moseg: unknown preset 'papr' in --preset: did you mean 'paper'?\n")


def test_fetch_again_replaces_a_bad_first_download(net, server, describe, moseg):
    describe({"files": [{"name": "model.pth", "url": server.serve("/net.pth", CONTENT[:50])}]})
    assert moseg("weights", "fetch", "net").code == 0
    server.serve("/net.pth", CONTENT)
    assert moseg("weights", "fetch", "net").code == 0 and net.read_bytes() == CONTENT[:50]
    assert moseg("weights", "fetch", "net", "--again").code == 0 and net.read_bytes() == CONTENT
    assert moseg("weights", "verify", "net").code == 0


@pytest.mark.parametrize("arguments", [(), ("nut",), ("--preset", "papr")])
def test_bad_use_of_fetch_is_exit_code_two(net, moseg, arguments):
    ran = moseg("weights", "fetch", *arguments)
    assert ran.code == 2 and len(ran.err.splitlines()) == 1


def test_non_commercial_weights_need_the_flag(net, server, describe, moseg):
    files = [{"name": "model.pth", "url": server.serve("/net.pth", CONTENT)}]
    describe({"licence": "CC-BY-NC-4.0", "is_non_commercial": True, "files": files})
    refused = moseg("weights", "fetch", "net")
    assert refused.code == 2
    assert "CC-BY-NC-4.0" in refused.err and "--non-commercial" in refused.err
    assert moseg("weights", "fetch", "net", "--non-commercial").code == 0


def test_a_licence_with_conditions_is_named_to_be_accepted(net, server, describe, moseg):
    files = [{"name": "model.pth", "url": server.serve("/net.pth", CONTENT)}]
    describe({"licence": "SAM-License", "has_conditions": True, "files": files})
    refused = moseg("weights", "fetch", "net", "--non-commercial")
    assert refused.code == 2 and "--accept-licence SAM-License" in refused.err
    assert moseg("weights", "fetch", "net", "--accept-licence", "SAM-License").code == 0


def test_verify_reports_right_wrong_and_missing_files(net, moseg, sha256):
    assert moseg("weights", "verify").out == f"0 files in {net.parent.parent}, 0 wrong or missing\n"
    moseg("weights", "fetch", "net", "--quiet")
    right = moseg("weights", "verify")
    assert right.code == 0
    assert right.out.splitlines()[0] == f"net/model.pth: SHA-256 {sha256(CONTENT)}"
    net.write_bytes(CONTENT[::-1])
    wrong = moseg("weights", "verify", "net")
    assert wrong.code == 1
    assert f"WRONG, SHA-256 {sha256(CONTENT[::-1])}, expected {sha256(CONTENT)}" in wrong.out
    assert net.read_bytes() == CONTENT[::-1]
    net.unlink()
    assert moseg("weights", "verify", "net").code == 1


def test_verify_reports_files_without_a_known_digest(net, describe, moseg):
    describe({"files": [{"name": "model.pth"}]})
    net.parent.mkdir()
    net.write_bytes(CONTENT)
    ran = moseg("weights", "verify")
    assert ran.code == 0 and "nothing says what it must be" in ran.out


def test_tiny_checkpoints_are_read_by_their_networks(tmp_path, moseg, monkeypatch):
    from moseg.tasks.networks.raft import build_raft
    from moseg.workflows.weights.folder import open_weights

    ran = moseg("weights", "tiny", tmp_path / "tiny", "--only", "raft-large")
    assert ran.code == 0 and f"export MOSEG_WEIGHTS={tmp_path}/tiny" in ran.out
    weights = open_weights({"MOSEG_WEIGHTS": str(tmp_path / "tiny")}, offline=True)
    item = weights.item("raft-large")
    weights.ensure(item)
    build_raft(weights.read(item, weights.digests(item)))


@pytest.mark.parametrize("architecture", declared_names("weights.architecture"))
def test_every_network_has_a_tiny_checkpoint(tmp_path, architecture):
    from moseg.workflows.weights.catalogue import CATALOGUE
    from moseg.workflows.weights.folder import open_weights
    from moseg.workflows.weights.tiny.make_tiny import make_tiny

    item = next(item for item in CATALOGUE if item.architecture == architecture)
    make_tiny(tmp_path, [item], seed=0)
    weights = open_weights({"MOSEG_WEIGHTS": str(tmp_path)}, offline=True)
    own = weights.item(item.name)
    checkpoint = weights.read(own, weights.digests(own))
    assert own.architecture == architecture and checkpoint.tensors
    assert sum(path.stat().st_size for path in tmp_path.rglob("*.*")) < 2 * 10**6


def test_tiny_checkpoints_follow_from_their_seed(tmp_path, moseg):
    def files(name, *arguments):
        assert moseg("weights", "tiny", tmp_path / name, "--only", "raft-large", *arguments).code == 0
        return {path.relative_to(tmp_path / name): path.read_bytes() for path in (tmp_path / name).rglob("*.*")}

    first = files("a")
    assert files("a") == files("b") == first
    assert files("c", "--seed", "1") != first


def test_tiny_checkpoints_never_replace_own_items(net, moseg):
    before = (net.parent.parent / "weights.json").read_text()
    ran = moseg("weights", "tiny", net.parent.parent, "--only", "raft-large")
    assert ran.code == 2 and "items of your own: net" in ran.err
    assert (net.parent.parent / "weights.json").read_text() == before


@pytest.mark.parametrize("name", ["model.pth", "model.pth.partial"])
def test_tiny_checkpoints_never_replace_fetched_weights(tmp_path, moseg, name):
    fetched = tmp_path / "cache" / "raft-large" / name
    fetched.parent.mkdir(parents=True)
    fetched.write_bytes(CONTENT)
    ran = moseg("weights", "tiny", tmp_path / "cache", "--only", "pips,raft-large")
    assert ran.code == 2 and "existing weights: raft-large; expected another folder" in ran.err
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == [fetched]
    assert fetched.read_bytes() == CONTENT
    assert moseg("weights", "tiny", tmp_path / "cache", "--only", "raft-small").code == 0
    assert moseg("weights", "tiny", tmp_path / "cache", "--only", "raft-small").code == 0


def test_tiny_checkpoints_without_the_libraries_of_networks_are_exit_code_two(tmp_path, moseg, monkeypatch):
    monkeypatch.setattr("moseg.workflows.weights.reading.find_spec", lambda name: None)
    ran = moseg("weights", "tiny", tmp_path / "tiny", "--only", "raft-large")
    assert ran.code == 2 and "pip install 'moseg[models]'" in ran.err
    assert not (tmp_path / "tiny").exists()


@pytest.mark.parametrize("only", [",", ""])
def test_no_tiny_item_is_exit_code_two(tmp_path, moseg, only):
    ran = moseg("weights", "tiny", tmp_path / "tiny", "--only", only)
    assert ran.code == 2 and "no item named in --only" in ran.err
    assert not (tmp_path / "tiny").exists()


def test_tiny_prints_the_items_it_wrote(tmp_path, moseg):
    moseg("weights", "tiny", tmp_path / "tiny", "--only", "raft-large, raft-small")
    items = json.loads((tmp_path / "tiny" / "weights.json").read_text())["items"]
    assert [item["name"] for item in items] == ["raft-large", "raft-small"]
    assert all("sha256" not in file for item in items for file in item["files"])


def test_an_unknown_tiny_item_is_exit_code_two(tmp_path, moseg):
    assert moseg("weights", "tiny", tmp_path / "tiny", "--only", "raft-lrge").code == 2
    assert not (tmp_path / "tiny").exists()


def test_again_refuses_items_of_known_digest(moseg, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path))
    ran = moseg("weights", "fetch", "raft-large", "--again")
    assert ran.code == 2 and "nothing to fetch anew" in ran.err and "raft-large" in ran.err
