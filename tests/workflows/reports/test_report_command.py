"""`moseg report` and `--report`: the page of a run, from the artifacts still stored."""

import json
import os
import shutil
import sys

import pytest

from moseg.schemas.recipes import split_ref
from moseg.store import open_store
from moseg.workflows.reports import panels
from moseg.workflows.reports.from_log import report_run
from moseg.workflows.reports.run_report import write_report
from moseg.workflows.runlog.status import list_runs

pytestmark = pytest.mark.usefixtures("in_empty_folder")

SECTIONS = ("--section-length", "4", "--set", "sections.overlap=2")


@pytest.fixture
def report(moseg, evaluated_copy, tmp_path):
    """Report on a run of the evaluated squares."""

    def call(*arguments):
        options = ("--quiet", "--store", evaluated_copy.store, "-o", tmp_path / "report.html")
        return moseg("report", *arguments, *options)

    return call


@pytest.fixture(scope="module")
def ablated(write_squares, tmp_path_factory):
    """Folder of a store, of the JSON and of the page that an ablation left, and its output; its source is gone."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("ablated")
    write_squares(folder / "data" / "squares")
    arguments = ("ablate", "--dataset", "folder", "--root", folder / "data", "--store", folder / "store", *SECTIONS)
    outputs = ("--json", folder / "ablation.json", "--report", folder / "ablation.html", "--quiet")
    words = [str(argument) for argument in (*arguments, *outputs)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["/bin/moseg", *words])
        assert run(words) == 0
    shutil.rmtree(folder / "data")
    return folder


@pytest.fixture(scope="module")
def ablation(ablated):
    """The page of that run, made of its log and its store."""
    return report_run(open_store(str(ablated / "store"), create=False), "latest")


def _assert_one_line(ran, code, *words):
    assert ran.code == code and len(ran.err.splitlines()) == 1
    assert all(str(word) in ran.err for word in words), ran.err


def _rows(table):
    return dict(table.rows)


def _drop(store, *tasks):
    for task in tasks:
        for ref in list(store.refs(task)):
            store.remove(ref)


def _damage(folder, store, task):
    """Flip a byte of the arrays of an artifact of a task, and return its reference."""
    ref = sorted(store.refs(task))[0]
    key = split_ref(ref)[1]
    path = folder / "objects" / task / key[:2] / key / "arrays.zip"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 255
    path.write_bytes(content)
    return ref


def test_the_log_and_the_store_are_enough_when_the_source_is_gone(ablation):
    assert ablation.title == "folder: fused, oc-depth, oc, trajs, base"
    facts = dict(ablation.facts)
    assert facts["command"].startswith("moseg ablate --dataset folder") and facts["run"].endswith("(finished)")
    (sequence,) = ablation.sequences
    assert (sequence.name, sequence.num_frames, sequence.shape) == ("squares", 10, (96, 128))
    assert sequence.layers and sequence.video is not None and sequence.missing == ()
    assert [panel.variant for panel in sequence.variants] == ["fused", "oc-depth", "oc", "trajs", "base"]
    assert all(panel.missing == () for panel in sequence.variants)
    titles = [matrix.title for matrix in sequence.variants[0].matrices]
    assert titles[-1] == "fused kernel"
    assert titles[:-1] == ["residuals, trajs", "residuals, oc-depth", "affinity, trajs", "affinity, oc-depth"]
    assert sequence.variants[-1].matrices == () and sequence.variants[-1].eigenvalues is None
    assert [each.motion for each in sequence.variants[-1].objects] == [0, 1, 2]
    assert {row.name: (row.value, row.default) for row in ablation.parameters} == {
        "sections.length": ("4", "30"),
        "sections.overlap": ("2", "12"),
    }
    assert all(row.description for row in ablation.parameters)


def test_tables_are_those_of_the_json(ablated, ablation):
    means, *tables = ablation.scores
    rows = json.loads((ablated / "ablation.json").read_text())["rows"]
    fields = ("P", "R", "F", "J", "boundary_F", "J_objects", "boundary_F_objects")
    # Variants with the same figures have one row and one table.
    by_variant = {variant: cells for name, cells in means.rows for variant in name.split(", ")}
    tables = {variant: table for table in tables for variant in table.title.split(", ")[1:]}
    assert set(by_variant) == set(tables) == {row["variant"] for row in rows}
    assert len(set(by_variant.values())) == len(means.rows)
    for row in rows:
        mean = tuple(row["mean"][field] for field in fields)
        assert by_variant[row["variant"]] == pytest.approx(mean)
        # The mean of one sequence is that sequence.
        squares = tuple(row["sequences"]["squares"][field] for field in fields)
        assert _rows(tables[row["variant"]]) == {"squares": squares}


def test_a_page_of_html_is_written_by_the_run_itself(ablated):
    text = (ablated / "ablation.html").read_text(encoding="utf-8")
    assert text.lower().startswith("<!doctype html>")
    assert "squares" in text and "fused kernel" in text


def test_a_warm_run_reports_without_computing_and_shows_the_same(evaluated_copy, moseg, pages):
    store = open_store(str(evaluated_copy.store), create=False)
    runs, refs = list_runs(store), set(store.refs())
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--report", "deep/warm.html")
    assert ran.code == 0 and "\n0 artifacts computed" in ran.out
    assert ran.out.splitlines()[-1].startswith("report: deep/warm.html (")
    assert (set(store.refs()), list_runs(store)) == (refs, runs)
    assert moseg("report", "--store", evaluated_copy.store).code == 0
    warm, logged = pages
    assert dict(warm.facts)["run"].startswith("computed nothing")
    assert sum(stage.computed for stage in warm.stages) == 0 < sum(stage.reused for stage in warm.stages)
    assert sum(stage.computed for stage in logged.stages) == evaluated_copy.report["store"]["computed"]
    assert (warm.title, warm.notes, warm.scores, warm.parameters) == logged[:1] + logged[2:4] + logged[6:]
    assert [panel.objects for panel in warm.sequences[0].variants] == [
        panel.objects for panel in logged.sequences[0].variants
    ]
    assert [layer.name for layer in warm.sequences[0].layers] == [layer.name for layer in logged.sequences[0].layers]


@pytest.mark.parametrize("command", ["report", "eval"])
def test_an_output_that_cannot_be_written_is_named_before_the_work(command, evaluated_copy, moseg, tmp_path):
    (tmp_path / "file").write_text("")
    option, data = ("-o", ()) if command == "report" else ("--report", evaluated_copy.arguments[1:])
    ran = moseg(command, *data, "--store", tmp_path / "other", option, tmp_path / "file" / "report.html")
    _assert_one_line(ran, 2, "cannot write", tmp_path / "file")
    assert not (tmp_path / "other").exists()


def test_a_run_is_found_by_its_start(report, evaluated_copy, pages):
    run = list_runs(open_store(str(evaluated_copy.store)))[0]
    ran = report(run[:6], "--frames", "1")
    assert (ran.code, ran.err) == (0, "") and ran.out.startswith("report: ")
    assert dict(pages[0].facts)["run"] == f"{run} (finished)"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nineteen",), ("no such run", "nineteen")),
        (("lastest",), ("no such run", "did you mean 'latest'?")),
        (("latest", "--sequences", "squares,circles"), ("no such sequence", "circles", "squares")),
        (("latest", "--frames", "0"), ("--frames",)),
    ],
    ids=["run", "misspelt", "sequence", "frames"],
)
def test_a_wrong_run_sequence_or_number_of_frames_is_one_line(report, tmp_path, arguments, words):
    _assert_one_line(report(*arguments), 2, *words)
    assert not (tmp_path / "report.html").exists()


def test_frames_and_sequences_are_chosen(report, pages):
    assert report("latest", "--frames", "3", "--sequences", "squares,squares").code == 0
    (sequence,) = pages[0].sequences
    assert len(sequence.frames) == 3


def test_the_report_of_an_unfinished_run_says_so(report, evaluated_copy, pages):
    for log in (evaluated_copy.store / "logs").rglob("*.jsonl"):
        log.write_text("".join(line for line in log.read_text().splitlines(True) if '"closed"' not in line))
    assert report("latest", "--frames", "1").code == 0
    state = dict(pages[0].facts)["run"].partition(" ")[2].strip("()")
    assert state == "running" and any(note.startswith("the run is running") for note in pages[0].notes)
    _drop(open_store(str(evaluated_copy.store)), "score", "segmentation", "clustering")
    assert report("latest", "--frames", "1").code == 0
    (sequence,) = pages[1].sequences
    said = [*pages[1].notes, *sequence.missing, *sequence.variants[0].missing]
    assert not [text for text in said if "collected" in text]
    assert any("scores are not computed yet" in note for note in pages[1].notes)
    assert [text.partition(":")[0] for text in said[-2:]] == ["Not computed yet"] * 2


def test_a_run_that_gc_keeps_can_still_be_reported(report, evaluated_copy, moseg, pages):
    for log in (evaluated_copy.store / "logs").rglob("*.jsonl"):
        os.utime(log, (0, 0))
    collect = ("store", "gc", "--delete", "--grace-hours", "0", "--quiet", "--store", evaluated_copy.store)
    assert "the logs of 0 ended runs" in moseg(*collect).out
    assert report("latest", "--frames", "1").code == 0
    (sequence,) = pages[0].sequences
    assert sequence.layers and sequence.missing == sequence.variants[0].missing == ()
    assert "the logs of 1 ended runs" in moseg(*collect, "--forget", "latest").out
    _assert_one_line(report("latest"), 2, "no such run")


def test_many_sequences_are_all_in_the_tables_and_the_first_in_pictures(
    write_squares, moseg, tmp_path, monkeypatch, pages
):
    for seed, name in enumerate("abc"):
        write_squares(tmp_path / "data" / name, num_frames=4, seed=seed)
    monkeypatch.setattr(panels, "MAX_SEQUENCES", 2)
    data = ("--dataset", "folder", "--root", tmp_path / "data", "--variant", "base", "--quiet")
    assert moseg("eval", *data, "--report", "report.html").code == 0
    assert moseg("report").code == moseg("report", "--sequences", "c").code == 0
    for made in pages:
        assert [name for name, _ in made.scores[0].rows] == ["a", "b", "c", "mean"]
    for made in pages[:2]:
        assert [sequence.name for sequence in made.sequences] == ["a", "b"]
        assert any("--sequences" in note for note in made.notes)
    assert [sequence.name for sequence in pages[2].sequences] == ["c"]
    assert not any("--sequences" in note for note in pages[2].notes)


def test_what_was_collected_is_named_and_the_rest_is_shown(report, evaluated_copy, pages):
    store = open_store(str(evaluated_copy.store), create=False)
    assert report().code == 0
    _drop(store, "fundamental_residual", "score")
    assert report().code == 0
    whole, rest = pages
    (panel,) = rest.sequences[0].variants
    (said,) = panel.missing
    assert "collected since the run" in said and "): residuals, trajs [fundamental_residual/" in said
    assert len(panel.matrices) == len(whole.sequences[0].variants[0].matrices) - 1
    assert set(_rows(rest.scores[0])) == {"squares"}
    assert all(value is None for values in _rows(rest.scores[0]).values() for value in values)
    assert any(note.startswith("1 of 1 scores are not in the store") for note in rest.notes)
    _drop(store, "linking", "clustering", "affinity", "flow_residual", "segmentation", "flow", "frame", "annotation")
    assert report().code == 0
    (panel,) = pages[2].sequences[0].variants
    assert (panel.matrices, panel.eigenvalues, panel.objects) == ((), None, ())
    # The reason once, then all that it is the reason for.
    assert len(pages[2].sequences[0].missing) == 2 and len(panel.missing) == 1
    assert panel.missing[0].count(" [") == 7 and panel.missing[0].count("collected") == 1


@pytest.mark.parametrize("task", ["affinity", "segmentation"])
def test_damage_is_named_by_a_report_and_repaired_by_the_run(task, report, evaluated_copy, moseg, pages, tmp_path):
    store = open_store(str(evaluated_copy.store), create=False)
    ref = _damage(evaluated_copy.store, store, task)
    _assert_one_line(report(), 1, ref, "moseg store verify")
    assert not (tmp_path / "report.html").exists()
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--report", "mended.html")
    assert ran.code == 0 and "\n1 artifacts computed" in ran.out
    assert report().code == 0
    assert all(panel.missing == () for made in pages for panel in made.sequences[0].variants)


def test_a_run_computes_what_its_page_lacks(report, evaluated_copy, moseg, pages):
    store = open_store(str(evaluated_copy.store), create=False)
    _drop(store, "saliency", "fundamental_residual", "flow_residual")
    assert moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--report", "whole.html").code == 0
    assert pages[0].sequences[0].missing == pages[0].sequences[0].variants[0].missing == ()
    assert {"saliency", "fundamental_residual", "flow_residual"} <= {split_ref(ref)[0] for ref in store.refs()}


def test_a_name_in_another_encoding_is_escaped(make_page, tmp_path):
    page = make_page("dog")._replace(title=os.fsdecode(b"f\xfcr dich"))
    assert write_report(tmp_path / "report.html", page).startswith(f"report: {tmp_path}/report.html (")
    assert r"f\udcfcr dich" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_user_s_video_is_reported(squares, moseg, pages, tmp_path):
    frames = tmp_path / "für dich"
    shutil.copytree(squares / "squares" / "frames", frames)
    ran = moseg("segment", frames, "--quiet", *SECTIONS, "--fps", "12", "--report", "own.html", "--motions", "2")
    assert ran.code == 0 and ran.out.splitlines()[-1].startswith("report: own.html (")
    assert moseg("report").code == 0
    for made in pages:
        assert (made.title, made.scores) == ("für dich: fused", ())
        (sequence,) = made.sequences
        assert sequence.video.fps == 12 and len(sequence.objects) > 0
        assert all(0 < row.sure_percent <= 100 and 0 < row.complete_percent <= 100 for row in sequence.objects)
        assert sequence.variants[0].eigenvalues.how.startswith("Given: 2 (clustering.motions)")
