"""The command line: its output, its files and its exit codes."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import Variant
from moseg.store import open_store

pytestmark = pytest.mark.usefixtures("in_empty_folder")

SCORES = {"P", "R", "F", "J"}


def _tree(folder):
    """Return all files below a folder with their sizes and modification times."""
    return {path: (path.stat().st_size, path.stat().st_mtime_ns) for path in sorted(folder.rglob("*"))}


def test_a_fault_is_exit_code_one_with_its_trace(moseg, monkeypatch):
    def fail(name, *arguments, **options):
        raise RuntimeError("broken")

    monkeypatch.setattr("moseg.workflows.api.evaluation.open_dataset", fail)
    ran = moseg("eval")
    assert ran.code == 1
    assert ran.err.startswith("Traceback")
    assert ran.err.splitlines()[-1] == "moseg: a fault, not your input: RuntimeError: broken"


def test_an_interruption_says_that_the_run_can_be_resumed(moseg, monkeypatch):
    def interrupt(name, *arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("moseg.workflows.api.evaluation.open_dataset", interrupt)
    ran = moseg("eval")
    assert ran.code == 130
    assert len(ran.err.splitlines()) == 1


def test_without_a_command_the_help_is_shown(moseg):
    ran = moseg()
    assert ran.code == 0
    for command in ("segment", "eval", "ablate", "plan", "score", "store", "datasets", "backends"):
        assert command in ran.out


def test_the_console_script_ends_with_the_exit_code():
    script = Path(sys.executable).with_name("moseg")
    if not script.exists():
        pytest.skip(f"moseg is not installed beside {sys.executable}")
    ran = subprocess.run([script, "eval", "--dataset", "sintetic"], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr.startswith("moseg: unknown data set")


def _assert_report(report, dataset, variants):
    assert report.keys() >= {"dataset", "rows", "store", "seconds"}
    assert report["dataset"] == dataset
    assert [row["variant"] for row in report["rows"]] == variants
    for row in report["rows"]:
        assert row.keys() >= {"variant", "sequences", "mean"}
        for scores in (row["mean"], *row["sequences"].values()):
            assert scores.keys() >= SCORES
            assert all(0 <= value <= 100 for value in scores.values())
    assert report["store"].keys() >= {"computed", "reused"}
    assert report["seconds"] >= 0


def test_the_report_of_an_evaluation(evaluated):
    _assert_report(evaluated.report, "folder", ["fused"])
    (row,) = evaluated.report["rows"]
    assert list(row["sequences"]) == ["squares"]
    assert row["mean"] == row["sequences"]["squares"]
    assert evaluated.report["store"]["computed"] > 0
    # Both squares, which move on their own over a panning backdrop, are found.
    assert row["mean"]["F"] > 50


def test_an_ablation_after_an_evaluation_reuses_every_cue(evaluated_copy, moseg, tmp_path):
    arguments = ["ablate", *evaluated_copy.arguments[1:], "--store", evaluated_copy.store]
    ran = moseg(*arguments, "--json", tmp_path / "ablation.json")
    assert (ran.code, ran.err) == (0, "")
    report = json.loads((tmp_path / "ablation.json").read_text())
    _assert_report(report, "folder", [variant.value for variant in Variant])
    assert report["rows"][0] == evaluated_copy.report["rows"][0]
    stages = dict(re.findall(r"│ (\w+) +│ +(\d+) │ +\d+ │ +\S+ │", ran.out))
    assert {"flow", "tracks"} <= stages.keys()
    cues = {"ingest", "flow", "saliency", "proposals", "linking", "tracks", "fundamental", "fundamental_residual"}
    assert {stage: stages[stage] for stage in cues & stages.keys()} == dict.fromkeys(cues & stages.keys(), "0")
    assert 0 < report["store"]["computed"] == sum(map(int, stages.values()))


def test_a_plan_computes_and_stores_nothing(evaluated_copy, moseg):
    before = _tree(evaluated_copy.store)
    arguments = ["plan", *(word for word in evaluated_copy.arguments[1:] if word != "--quiet")]
    warm = moseg(*arguments, "--store", evaluated_copy.store)
    other = moseg(*arguments, "--store", evaluated_copy.store, "--set", "affinity.scale=0.7")
    unseen = moseg(*arguments, "--store", evaluated_copy.store, "--set", "max_side=64")
    assert [warm.code, other.code, unseen.code] == [0, 0, 0]
    assert re.search(r"^0 artifacts to compute", warm.out, re.MULTILINE)
    # Two affinities, their clustering, three sections of labels and a score.
    assert re.search(r"^7 artifacts to compute, \d+ to reuse$", other.out, re.MULTILINE)
    # The annotation has its own size; it and the motion network are remembered.
    assert f"{evaluated_copy.report['store']['computed'] - 2} artifacts to compute, 0 to reuse" in unseen.out
    assert _tree(evaluated_copy.store) == before


@pytest.mark.parametrize("change", [("--variant", "oc"), ("--variant", "base", "--set", "max_side=64")])
def test_a_plan_counts_what_the_run_then_computes(evaluated_copy, moseg, tmp_path, change):
    options = (*evaluated_copy.arguments[1:], *change, "--store", evaluated_copy.store)
    plan = moseg("plan", *(word for word in options if word != "--quiet"))
    assert moseg("eval", *options, "--json", tmp_path / "report.json").code == 0
    computed = json.loads((tmp_path / "report.json").read_text())["store"]["computed"]
    assert re.search(rf"^{computed} artifacts to compute", plan.out, re.MULTILINE)


def test_saved_masks_are_scored_as_they_were_evaluated(evaluated, moseg, tmp_path, write_image):
    store = open_store(str(evaluated.store), create=False)
    starts = {store.manifest(ref).recipe.params["section"]: ref for ref in store.refs("segmentation")}
    labels = np.concatenate([store.read(ref, "labels") for _, ref in sorted(starts.items())])
    for number, frame in enumerate(labels):
        write_image(tmp_path / "saved" / "squares" / f"{number:05d}.png", frame.astype(np.uint8))
    data = ("--dataset", "folder", "--root", evaluated.root, "--predictions", tmp_path / "saved", "--name", "saved")
    ran = moseg("score", *data, "--json", tmp_path / "score.json", "--quiet")
    assert (ran.code, ran.err) == (0, "")
    report = json.loads((tmp_path / "score.json").read_text())
    _assert_report(report, "folder", ["saved"])
    assert report["rows"][0]["mean"] == pytest.approx(evaluated.report["rows"][0]["mean"])


def test_empty_masks_score_as_no_motion(squares, moseg, tmp_path, write_image):
    for number in range(10):
        write_image(tmp_path / "given" / f"{number:05d}.png", np.zeros((96, 128), np.uint8))
    given = ("--proposals", f"folder:{tmp_path / 'given'}", "--store", tmp_path / "store", "--quiet")
    ran = moseg("segment", squares / "squares" / "frames", *given, "--out", tmp_path / "out")
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.startswith("0 moving objects in 10 frames")
    masks = [np.asarray(Image.open(path)) for path in sorted((tmp_path / "out" / "masks").iterdir())]
    assert len(masks) == 10
    assert not np.any(masks)
    ran = moseg("eval", "--dataset", "folder", "--root", squares, *given, "--json", tmp_path / "report.json")
    assert ran.code == 0
    assert json.loads((tmp_path / "report.json").read_text())["rows"][0]["mean"]["R"] == 0


def test_given_masks_are_the_objects(squares, moseg, tmp_path):
    frames, masks = squares / "squares" / "frames", squares / "squares" / "masks"
    ran = moseg("segment", frames, "--proposals", f"folder:{masks}", "--variant", "base", "--out", "out", "--quiet")
    assert ran.code == 0
    assert ran.out.startswith("2 moving objects in 10 frames")
    for number in range(10):
        found, given = (np.asarray(Image.open(folder / f"{number:05d}.png")) for folder in (Path("out/masks"), masks))
        np.testing.assert_array_equal(found > 0, given > 0)


def test_the_store_lists_what_it_shows(evaluated, moseg):
    listed = moseg("store", "ls", "--store", evaluated.store).out.split()
    assert listed == sorted(listed)
    assert len(moseg("store", "ls", "--task", "flow", "--store", evaluated.store).out.split()) == 18
    (score,) = (ref for ref in listed if ref.startswith("score/"))
    shown = json.loads(moseg("store", "show", score, "--store", evaluated.store).out)
    assert shown["recipe"]["task"] == "score"
    assert shown["attributes"].items() >= evaluated.report["rows"][0]["mean"].items()
    by_key = moseg("store", "show", score.partition("/")[2][:12], "--store", evaluated.store)
    assert json.loads(by_key.out) == shown


def test_why_names_the_field_that_caused_a_miss(evaluated_copy, moseg):
    store = ("--store", evaluated_copy.store)
    (before,) = moseg("store", "ls", "--task", "clustering", *store).out.split()
    assert "only artifact of its task" in moseg("store", "why", before, *store).out
    assert moseg(*evaluated_copy.arguments, *store, "--motions", "3").code == 0
    (after,) = {*moseg("store", "ls", "--task", "clustering", *store).out.split()} - {before}
    why = moseg("store", "why", after, *store).out
    assert before in why
    assert "params.num_motions: 3 here, null there" in why


def test_verify_finds_and_quarantines_damaged_artifacts(evaluated_copy, moseg):
    store = ("--store", evaluated_copy.store)
    assert moseg("store", "verify", *store).code == 0
    damaged = next((evaluated_copy.store / "objects" / "flow").rglob("arrays.zip"))
    damaged.write_bytes(damaged.read_bytes()[:-1])
    found = moseg("store", "verify", *store)
    assert found.code == 1
    assert damaged.parent.name in found.out
    assert moseg("store", "verify", "--quarantine", *store).code == 1
    sound = moseg("store", "verify", *store)
    assert sound.code == 0
    assert "0 bad" in sound.out


def test_gc_keeps_what_a_run_needs_until_it_is_forgotten(evaluated_copy, moseg):
    store = ("--store", evaluated_copy.store)
    before = moseg("store", "ls", *store).out
    assert moseg("store", "gc", "--delete", "--grace-hours", "0", *store).code == 0
    assert moseg("store", "ls", *store).out == before
    assert moseg("store", "gc", "--forget", "nobody", *store).code == 2
    run = moseg("store", "ls", "--runs", *store).out.split()[0]
    preview = moseg("store", "gc", "--forget", run, "--grace-hours", "0", *store)
    assert moseg("store", "ls", *store).out == before
    done = moseg("store", "gc", "--forget", run, "--delete", "--grace-hours", "0", *store)
    assert moseg("store", "ls", *store).out == ""
    assert (preview.code, done.code) == (0, 0)
    assert preview.out.replace(" would be removed (--delete does it)", " removed").replace("would be ", "") == done.out
    assert moseg(*evaluated_copy.arguments, *store).code == 0


def test_du_counts_artifacts_and_bytes(evaluated, moseg):
    lines = moseg("store", "du", "--store", evaluated.store).out.splitlines()
    num_artifacts = len(moseg("store", "ls", "--store", evaluated.store).out.split())
    assert lines[-1].split()[-2:] == [str(num_artifacts), "total"]
    assert any(line.split()[-2:] == ["18", "flow"] for line in lines)


@pytest.mark.parametrize("command", ["datasets", "backends"])
def test_overviews_need_no_data_and_no_store(moseg, command):
    ran = moseg(command)
    assert (ran.code, ran.err) == (0, "")
    assert "synthetic" in ran.out
    assert not list(Path().iterdir())


def test_names_in_square_brackets_are_names(moseg, squares, tmp_path):
    sequence = shutil.copytree(squares / "squares", tmp_path / "data [v2]" / "clip [bold]")
    saved = shutil.copytree(sequence / "masks", tmp_path / "masks" / "clip [bold]").parent
    data = ("--dataset", "folder", "--root", sequence.parent, "--predictions", saved, "--name", "[/b] :smile:")
    ran = moseg("score", *data, "--quiet")
    assert (ran.code, ran.err) == (0, "")
    assert "clip [bold]" in ran.out and "[/b] :smile:" in ran.out
