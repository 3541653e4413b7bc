"""`moseg plan` reads the store, lists only the artifacts to compute, and writes nothing."""

import re

import pytest


def _tree(folder):
    """Return all files below a folder with their contents."""
    return {path: path.is_file() and path.read_bytes() for path in sorted(folder.rglob("*"))}


@pytest.fixture
def plan(evaluated, moseg):
    """Return a function that plans the squares and returns the artifacts to compute, and counts by stage."""

    def call(store, *settings):
        options = [word for word in evaluated.arguments[1:] if word != "--quiet"]
        for setting in settings:
            options += ["--set", setting]
        before = _tree(store)
        ran = moseg("plan", *options, "--store", store)
        assert (ran.code, ran.err) == (0, "")
        assert _tree(store) == before
        stages = re.findall(r"│ (\w+) +│ +(\d+) │ +(\d+) │", ran.out)
        total = int(re.search(r"^(\d+) artifacts to compute", ran.out, re.MULTILINE)[1])
        return total, {stage: (int(computed), int(reused)) for stage, computed, reused in stages}

    return call


def test_without_a_store_every_artifact_is_to_compute(evaluated, plan, tmp_path):
    total, stages = plan(tmp_path / "absent" / "store")
    assert total == evaluated.report["store"]["computed"]
    assert all(reused == 0 for _, reused in stages.values())
    assert not (tmp_path / "absent").exists()


@pytest.mark.parametrize("damage", [b"", b"{}", b"\xff\x00 no JSON"])
def test_a_damaged_ingest_artifact_is_planned_again_and_left_alone(evaluated_copy, plan, damage):
    for path in (evaluated_copy.store / "objects" / "ingest").rglob("manifest.json"):
        path.write_bytes(damage)
    total, stages = plan(evaluated_copy.store)
    # One ingest artifact each of the frames, the annotation and the motion network; the leaves are still in the store.
    assert (total, stages["ingest"]) == (3, (3, 0))


def test_another_statistic_of_the_residuals_keeps_the_fits(evaluated_copy, plan):
    _, stages = plan(evaluated_copy.store, "fundamental.statistic=mean")
    num_residuals, _ = stages["fundamental_residual"]
    assert num_residuals > 0
    assert stages["fundamental"] == (0, num_residuals)
    computed = {stage for stage, (number, _) in stages.items() if number}
    assert computed == {"fundamental_residual", "affinity", "clustering", "segmentation", "score"}


def test_a_parameter_that_the_chosen_method_does_not_read_recomputes_nothing(evaluated_copy, plan):
    assert plan(evaluated_copy.store, "clustering.co_regularisation=0.3")[0] == 0
    assert plan(evaluated_copy.store, "affinity.ork_threshold=5")[0] == 0


def test_the_same_parameter_recomputes_a_method_that_reads_it(evaluated_copy, moseg, plan):
    fusion = "clustering.fusion=coregularised"
    assert moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--set", fusion).code == 0
    assert plan(evaluated_copy.store, fusion)[0] == 0
    assert plan(evaluated_copy.store, fusion, "clustering.co_regularisation=0.3")[0] > 0


def test_networks_can_be_planned_without_their_weights(evaluated, moseg, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "weights"))
    options = [word for word in evaluated.arguments[1:] if word != "--quiet"]
    ran = moseg("plan", *options, "--store", evaluated.store, "--preset", "paper")
    assert (ran.code, ran.err) == (0, "")
    assert re.search(r"│ detections +│ +3 │ +0 │", ran.out)
    (line,) = (line for line in ran.out.splitlines() if line.startswith("weights to fetch"))
    assert "moseg weights fetch ram grounding-dino-tiny" in line
    assert not (tmp_path / "weights").exists()
