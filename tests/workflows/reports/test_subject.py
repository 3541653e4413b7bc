"""A run's log names the subject of the run: enough to write its graph again."""

import json
import shlex

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.errors import InputError
from moseg.store import open_store
from moseg.workflows.engine import waves
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.runlog.status import list_runs, read_status

pytestmark = pytest.mark.usefixtures("in_empty_folder")

CONFIG = PipelineConfig.model_validate({"sections": {"length": 4, "overlap": 2}})


@pytest.fixture
def log_of(evaluated_copy):
    """The store of an evaluation, its latest run, and a function that rewrites the lines about its subject."""
    store = open_store(str(evaluated_copy.store), create=False)
    run = list_runs(store)[0]

    def rewrite(change):
        for path in (evaluated_copy.store / "logs" / run).glob("*.jsonl"):
            lines = [json.loads(line) for line in path.read_text().splitlines()]
            for line in lines:
                if line["event"] == "subject":
                    change(line)
            path.write_text("".join(f"{json.dumps(line, separators=(',', ':'))}\n" for line in lines))

    return store, run, rewrite


def test_the_graph_written_from_the_log_has_the_runs_artifacts(log_of):
    store, run, _ = log_of
    subject = read_subject(store, run)
    assert (subject.command, subject.dataset, subject.variants) == ("eval", "folder", (Variant.FUSED,))
    assert subject.config == CONFIG and subject.has_frames and subject.seeds is None
    ((leaves, fps),) = subject.sequences
    assert leaves.name == "squares" and fps is None
    graph = SequenceGraph(leaves, subject.config)
    graph.score(Variant.FUSED)
    assert set(graph.recipes) <= set(store.refs())
    assert store.present(leaves.frames) == set(leaves.frames)


def test_a_status_counts_no_line_about_the_subject_as_unreadable(log_of, moseg):
    store, run, _ = log_of
    assert read_status(store, run).num_unreadable == 0
    assert "unreadable" not in moseg("status", "latest", "--store", store.url).out


def test_a_run_that_computes_nothing_leaves_no_log_and_a_later_one_is_complete(evaluated_copy, moseg):
    store = open_store(str(evaluated_copy.store), create=False)
    before = list_runs(store)
    arguments = (*evaluated_copy.arguments, "--store", evaluated_copy.store)
    assert moseg(*arguments).code == 0
    assert list_runs(store) == before
    assert moseg(*arguments, "--variant", "oc").code == 0
    assert read_subject(store, list_runs(store)[0]).variants == (Variant.OC,)


def test_every_wave_is_written_once_also_those_before_the_log(write_squares, moseg, tmp_path, monkeypatch):
    for seed, name in enumerate("ab"):
        write_squares(tmp_path / "data" / name, num_frames=5, seed=seed)
    monkeypatch.setattr(waves, "FRAMES", 1)
    monkeypatch.setattr(waves, "FRAMES_PER_WORKER", 1)
    arguments = ("eval", "--dataset", "folder", "--root", tmp_path / "data", "--store", tmp_path / "store", "--quiet")
    assert moseg(*arguments, "--variant", "base").code == 0
    store = open_store(str(tmp_path / "store"), create=False)
    # Of the second run's waves the first has nothing to compute.
    subject = read_subject(store, list_runs(store)[0])
    assert store.remove(SequenceGraph(subject.sequences[1].leaves, subject.config).score(Variant.BASE))
    assert moseg(*arguments, "--variant", "base").code == 0
    assert len(list_runs(store)) == 2
    for run in list_runs(store):
        assert [sequence.leaves.name for sequence in read_subject(store, run).sequences] == ["a", "b"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda line: line["config"]["sections"].update(longness=3), "sections.longness"),
        (lambda line: line["sequences"][0]["leaves"].update(audio="x"), "audio"),
        (lambda line: line["sequences"][0]["leaves"]["frames"].__setitem__(0, "frame/xyz"), "frames.0"),
        (lambda line: line.update(variants=["fusion"]), "fus"),
        (lambda line: line.update(event="subjects"), "nothing to report"),
        (lambda line: line.update(colour="red"), "colour"),
    ],
    ids=["parameter", "leaf", "reference", "variant", "none", "field"],
)
def test_a_field_unknown_to_this_version_is_one_line(log_of, moseg, tmp_path, change, words):
    store, run, rewrite = log_of
    rewrite(change)
    with pytest.raises(InputError, match=run):
        read_subject(store, run)
    ran = moseg(*shlex.split(f"report {run} --store {store.url} -o {tmp_path / 'report.html'}"))
    assert ran.code == 2 and len(ran.err.splitlines()) == 1 and words in ran.err
    assert not (tmp_path / "report.html").exists()
    assert moseg("status", run, "--store", store.url).code == 0


def _cut_short(store, run, is_copy):
    """Cut the line about the subject, or a copy of it, as a full disk does."""
    for path in (store.root / "logs" / run).glob("*.jsonl"):
        lines = path.read_bytes().splitlines(keepends=True)
        about_subject = [line for line in lines if b'"subject"' in line]
        kept = lines if is_copy else [line for line in lines if line not in about_subject]
        path.write_bytes(b"".join(kept) + b"".join(line[: len(line) // 2] + b"\n" for line in about_subject))


def test_a_line_that_is_cut_short_is_skipped_and_noted(log_of):
    store, run, _ = log_of
    whole = read_subject(store, run)
    _cut_short(store, run, is_copy=True)
    subject = read_subject(store, run)
    assert subject == whole._replace(notes=subject.notes)
    (note,) = set(subject.notes) - set(whole.notes)
    assert note.startswith("1 of 2 lines of its log about its sequences are cut short")


def test_a_log_that_only_has_such_lines_is_not_called_one_of_another_version(log_of):
    store, run, _ = log_of
    _cut_short(store, run, is_copy=False)
    with pytest.raises(InputError, match=r"nothing to report.*cut short") as raised:
        read_subject(store, run)
    assert "version" not in str(raised.value)
