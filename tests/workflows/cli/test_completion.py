"""What the shell offers for a word that is being typed."""

import pytest

from moseg.workflows.cli.app import run

pytestmark = pytest.mark.usefixtures("in_empty_folder")


@pytest.fixture
def complete(monkeypatch, capsys):
    """Words that bash is offered behind a command line that ends where the cursor is."""

    def call(line):
        words = line.split(" ")
        monkeypatch.setenv("_MOSEG_COMPLETE", "complete_bash")
        monkeypatch.setenv("COMP_WORDS", line)
        monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
        with pytest.raises(SystemExit) as ended:
            run([])
        assert ended.value.code == 0
        captured = capsys.readouterr()
        assert captured.err == ""
        return captured.out.split()

    return call


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("moseg ev", ["eval"]),
        ("moseg store p", ["push", "pull"]),
        ("moseg eval --geom", ["--geometry"]),
        ("moseg segment a.mp4 --sens", ["--sensitivity"]),
        ("moseg eval --dataset kt3d", ["kt3dinsmoseg", "kt3dmoseg"]),
        ("moseg datasets show davis1", ["davis16"]),
        ("moseg eval --dataset hop", ["hopkins155", "hopkins12"]),
        ("moseg eval --variant o", ["oc-depth", "oc"]),
        ("moseg segment a.mp4 --preset ", ["weights-free", "paper", "modern"]),
        ("moseg plan --quality b", ["best"]),
        ("moseg eval --flow ", ["dis", "raft", "sea-raft", "groundtruth", "folder:"]),
        ("moseg segment --flow ", ["dis", "raft", "sea-raft", "folder:"]),
        ("moseg eval --depth d", ["dpt-dinov2", "depth-anything-v2", "depth-anything-3"]),
        ("moseg eval --tagger ram", ["ram", "ram-plus"]),
        ("moseg eval --motions ", ["gt", "auto"]),
        ("moseg eval --set affinity.ork_", ["affinity.ork_threshold=", "affinity.ork_reading="]),
        ("moseg eval --set flow.method=r", ["flow.method=raft"]),
        ("moseg config show clustering.count.affinity.f", ["fade", "fusion"]),
        ("moseg weights fetch raft-", ["raft-large", "raft-small"]),
        ("moseg weights tiny there --only pips,raft-l", ["pips,raft-large"]),
        ("moseg eval --sequences occ", ["occlusion"]),
    ],
)
def test_names_are_offered(complete, line, offered):
    found = complete(line)
    if line.startswith("moseg config show"):
        offered = [f"clustering.count.affinity.{name}" for name in offered]
    assert set(offered) <= set(found)
    start = line.rpartition(" ")[2]
    assert all(name.startswith(start) for name in found)


def test_runs_of_the_store_are_offered(complete, evaluated):
    found = complete(f"moseg status --store {evaluated.store} ")
    assert found[0] == "latest"
    assert len(found) == 2
    assert complete(f"moseg report --store {evaluated.store} l") == ["latest"]


def test_where_names_cannot_be_had_none_are_offered(complete):
    assert complete("moseg status --store nowhere ") == []
    assert complete("moseg eval --dataset davis16 --root nowhere --sequences ") == []
    assert complete("moseg eval --dataset unknown --sequences ") == []


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_gets_its_script(monkeypatch, capsys, shell):
    monkeypatch.setenv("_MOSEG_COMPLETE", f"source_{shell}")
    with pytest.raises(SystemExit):
        run([])
    script = capsys.readouterr().out
    assert "moseg" in script
    assert f"complete_{shell}" in script
