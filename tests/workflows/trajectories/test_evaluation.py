"""`moseg eval`, `ablate` and `plan` on labelled trajectories, from the files to the JSON."""

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest

from moseg.store import open_store

pytestmark = pytest.mark.usefixtures("in_empty_folder")

REPOSITORY = Path(__file__).parents[3]
DATA = Path(os.environ.get("MOSEG_TEST_DATA", REPOSITORY.parent / "shared" / "data")) / "kt3dmoseg"
MEAN = {"error", "median_error", "num_motions_correct"}
FAST = ("--set", "hypotheses.num_hypotheses=200")
VARIANTS = ["fused", "trajs", "homography", "affine"]


@pytest.fixture
def evaluate(moseg, clips, tmp_path):
    """Evaluates the clips into the test's store; returns the JSON and what was printed."""

    def call(*options, command="eval", store="store", fast=FAST):
        path = tmp_path / "report.json"
        arguments = ("--dataset", "kt3dmoseg", "--root", clips, "--store", tmp_path / store, "--quiet", *fast)
        ran = moseg(command, *arguments, "--json", path, *options)
        assert (ran.code, ran.err) == (0, "")
        return json.loads(path.read_text()), ran.out

    return call


@pytest.fixture
def planned(moseg, clips, tmp_path):
    """Stages that would compute something, with the number of artifacts; the plan leaves no file behind."""

    def call(*options, store="store"):
        arguments = ("--dataset", "kt3dmoseg", "--root", clips, "--store", tmp_path / store, *FAST)
        before = sorted((tmp_path / store).rglob("*"))
        ran = moseg("plan", *arguments, *options)
        assert (ran.code, ran.err) == (0, "")
        assert sorted((tmp_path / store).rglob("*")) == before
        rows = re.findall(r"│ (\w+) +│ +(\d+) │ +(\d+) │", ran.out)
        return {stage: int(computed) for stage, computed, _ in rows if int(computed)}

    return call


def _manifests(store):
    return {ref: store.manifest(ref) for ref in store.refs()}


def test_two_bodies_are_told_apart_and_the_report_has_its_shape(evaluate):
    report, out = evaluate("--motions", "gt")
    assert list(report) == ["dataset", "rows", "store", "seconds", "settings"]
    assert report["dataset"] == "kt3dmoseg" and report["store"]["reused"] == 0 < report["store"]["computed"]
    (row,) = report["rows"]
    assert list(row) == ["variant", "sequences", "mean"] and row["variant"] == "fused"
    assert list(row["sequences"]) == ["Seq005_Clip01", "Seq028_clip03"]
    for score in row["sequences"].values():
        assert list(score) == ["error", "num_motions", "num_motions_true"]
        # As one motion: 38. One of 65 trajectories is never seen.
        assert 0 <= score["error"] <= 10
        assert (score["num_motions"], score["num_motions_true"]) == (2, 2)
        assert isinstance(score["num_motions"], int)
    assert set(row["mean"]) == MEAN and row["mean"]["num_motions_correct"] == 100
    errors = [score["error"] for score in row["sequences"].values()]
    assert row["mean"]["error"] == pytest.approx(np.mean(errors))
    assert row["mean"]["median_error"] == pytest.approx(np.median(errors))
    assert "2 of the 22 clips ran; not on disk: Seq005_Clip02" in out
    assert "as published for all 22 clips" in out and "not measured here" in out


def test_seeds_are_averaged_and_their_spread_is_told(evaluate):
    options = ("--motions", "gt", "--variant", "affine")
    fast = ("--set", "hypotheses.num_hypotheses=8")
    (row,) = evaluate(*options, "--seeds", "3", fast=fast)[0]["rows"]
    assert set(row) == {"variant", "sequences", "mean", "seeds", "spread"}
    assert [entry["seed"] for entry in row["seeds"]] == [0, 1, 2]
    errors = [entry["mean"]["error"] for entry in row["seeds"]]
    assert len(set(errors)) > 1
    assert row["spread"] == pytest.approx(np.std(errors, ddof=1))
    for figure in MEAN:
        assert row["mean"][figure] == pytest.approx(np.mean([entry["mean"][figure] for entry in row["seeds"]]))
    for name, score in row["sequences"].items():
        alone = [evaluate(*options, "--seed", seed, fast=fast)[0]["rows"][0]["sequences"][name] for seed in range(3)]
        assert [entry["sequences"][name] for entry in row["seeds"]] == alone
        assert score["error"] == pytest.approx(np.mean([each["error"] for each in alone]))
        assert set(score) == {"error", "num_motions", "num_motions_true"}


def test_a_seed_alone_finds_what_the_seeds_have_computed(evaluate):
    seeds = evaluate("--seeds", "2", "--variant", "homography")[0]["rows"][0]["seeds"]
    report, _ = evaluate("--seed", "1", "--variant", "homography")
    assert report["store"]["computed"] == 0
    assert report["rows"][0]["mean"] == seeds[1]["mean"]


def test_another_number_of_motions_reuses_all_but_the_clustering(evaluate, planned):
    evaluate("--motions", "gt", "--seeds", "2")
    behind = {"trajectory_clustering": 4, "score": 4}
    assert planned("--motions", "3", "--seeds", "2") == behind
    assert planned("--motions", "auto", "--seeds", "2") == behind
    assert planned("--motions", "2", "--seeds", "2") == {}
    assert planned("--motions", "gt", "--seed", "1") == {}
    assert planned("--motions", "gt", "--seed", "2").keys() > {"hypotheses", "kernel"}


def test_variants_share_the_views(evaluate, planned):
    evaluate("--motions", "gt")
    behind = {"trajectory_clustering": 2, "score": 2}
    for variant in ("trajs", "homography", "affine"):
        assert planned("--motions", "gt", "--variant", variant) == behind
    assert planned("--motions", "gt", "--views", "homography,fundamental") == behind
    assert planned("--motions", "gt", "--set", "fused_point_models=homography,fundamental") == behind
    trifocal = planned("--motions", "gt", "--views", "homography,trifocal")
    assert trifocal == {"hypotheses": 2, "kernel": 2, **behind}


@pytest.mark.parametrize(
    ("setting", "stages"),
    [
        ("kernel.window=0.2", {"kernel", "trajectory_clustering", "score"}),
        ("trajectory_clustering.method=sum", {"trajectory_clustering", "score"}),
        ("hypotheses.gaps=1,3", {"hypotheses", "kernel", "trajectory_clustering", "score"}),
    ],
)
def test_a_parameter_recomputes_its_stage_and_what_follows(evaluate, planned, setting, stages):
    evaluate("--motions", "gt", "--variant", "fused")
    assert set(planned("--motions", "gt", "--set", setting)) == stages


def test_a_view_alone_reads_nothing_of_what_views_are_combined_by(evaluate, planned):
    evaluate("--motions", "gt", "--variant", "affine")
    settings = ("trajectory_clustering.method=sum", "trajectory_clustering.co_regularisation=0.5")
    for setting in settings:
        assert planned("--motions", "gt", "--variant", "affine", "--set", setting) == {}


def test_the_order_of_views_does_not_matter(evaluate):
    first, _ = evaluate("--motions", "gt", "--views", "affine,homography,fundamental")
    second, _ = evaluate("--motions", "gt", "--views", "fundamental,affine,homography")
    assert second["store"]["computed"] == 0 and second["rows"] == first["rows"]


def test_the_ablation_has_its_own_variants(evaluate):
    report, out = evaluate("--motions", "gt", command="ablate")
    assert [row["variant"] for row in report["rows"]] == VARIANTS
    assert "kernel" in out and f"{report['store']['computed']} artifacts computed" in out


def test_workers_give_the_same_keys_and_the_same_bytes(evaluate, tmp_path):
    evaluate("--motions", "auto", "--seeds", "2")
    evaluate("--motions", "auto", "--seeds", "2", "--workers", "1", store="other")
    here, there = (_manifests(open_store(str(tmp_path / name))) for name in ("store", "other"))
    assert here.keys() == there.keys() and len(here) > 30
    for ref, manifest in here.items():
        assert (manifest.arrays, manifest.attributes) == (there[ref].arrays, there[ref].attributes), ref


def test_the_objective_never_falls(evaluate, tmp_path):
    evaluate("--motions", "gt")
    store = open_store(str(tmp_path / "store"))
    objectives = [store.attributes(ref)["objective"] for ref in store.refs("trajectory_clustering")]
    assert len(objectives) == 2
    for objective in objectives:
        assert objective and all(np.diff(objective) >= -1e-9)


def test_landmarks_are_clustered_and_the_others_follow(evaluate, tmp_path):
    report, _ = evaluate("--motions", "gt", "--set", "kernel.max_tracks=40")
    for score in report["rows"][0]["sequences"].values():
        assert score["error"] <= 10 and score["num_motions"] == 2
    store = open_store(str(tmp_path / "store"))
    assert {store.manifest(ref).array("kernel").shape for ref in store.refs("kernel")} == {(3, 40, 40)}
    assert {store.manifest(ref).array("motion").shape for ref in store.refs("trajectory_clustering")} == {(65,)}


def test_a_gap_longer_than_the_clip_is_reduced(evaluate):
    report, _ = evaluate("--motions", "gt", "--set", "hypotheses.gaps=50")
    assert all(score["error"] <= 15 for score in report["rows"][0]["sequences"].values())


@pytest.mark.skipif(not DATA.is_dir(), reason="no real clips of KT3DMoSeg: set MOSEG_TEST_DATA to their folder")
def test_a_real_clip_of_two_motions_is_segmented(moseg, tmp_path):
    options = ("--sequences", "Seq013_Clip01", "--motions", "gt", "--quiet", "--store", tmp_path / "store")
    ran = moseg("eval", "--dataset", "kt3dmoseg", "--root", DATA, *options, "--json", tmp_path / "report.json")
    assert (ran.code, ran.err) == (0, "")
    (row,) = json.loads((tmp_path / "report.json").read_text())["rows"]
    assert row["mean"]["error"] <= 5  # 36.6 as one motion


@pytest.mark.skipif(not DATA.is_dir(), reason="no real clips of KT3DMoSeg: set MOSEG_TEST_DATA to their folder")
def test_the_number_of_motions_of_real_clips_is_found(moseg, tmp_path):
    names = ("Seq005_Clip01", "Seq028_Clip01", "Seq071_Clip01")
    options = ("--sequences", ",".join(names), "--motions", "auto", "--store", tmp_path / "store", "--quiet")
    ran = moseg("eval", "--dataset", "kt3dmoseg", "--root", DATA, *options, "--json", tmp_path / "report.json")
    assert (ran.code, ran.err) == (0, "")
    (row,) = json.loads((tmp_path / "report.json").read_text())["rows"]
    for name in names:
        found = row["sequences"][name]
        assert found["num_motions"] == found["num_motions_true"], name
        assert found["error"] <= 3, name
