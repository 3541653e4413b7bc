"""Counts of labels where nothing moves: of an evaluation, of saved masks, in reports and on sheets."""

import json
import re

import numpy as np
import pytest

from moseg.workflows.reports.content import Better

pytestmark = pytest.mark.usefixtures("in_empty_folder")

NUM_FRAMES, SHAPE = 6, (60, 80)


@pytest.fixture
def root(tmp_path, write_image):
    """Return a root with one recording of a camera that pans past noise."""
    noise = np.random.default_rng(0).integers(0, 256, (SHAPE[0], SHAPE[1] + 2 * NUM_FRAMES, 3), np.uint8)
    for number in range(NUM_FRAMES):
        image = noise[:, 2 * number : 2 * number + SHAPE[1]]
        write_image(tmp_path / "root" / "pan" / "frames" / f"{number:05d}.png", image)
    return tmp_path / "root"


@pytest.fixture
def masks(tmp_path, write_image):
    """Return a folder of masks in which 600 of 28,800 pixels and two of six frames have a label."""
    for number in range(NUM_FRAMES):
        labels = np.zeros(SHAPE, np.uint8)
        if number in (2, 3):
            labels[10:30, 20 + number : 35 + number] = 1
        write_image(tmp_path / "masks" / "pan" / f"{number:05d}.png", labels)
    return tmp_path / "masks"


HAND_COUNT = {"false_pixels": pytest.approx(100 * 600 / 28800), "false_frames": pytest.approx(100 / 3)}


@pytest.fixture
def run(moseg, root, masks, tmp_path):
    """Return a function that runs a command on the recording with the masks as proposals; it returns the output."""

    def call(command, *options):
        data = ("--dataset", "still", "--root", root, "--sequences", "pan", "--store", tmp_path / "store")
        ran = moseg(command, *data, "--proposals", f"folder:{masks}", "--section-length", "4", *options)
        assert (ran.code, ran.err) == (0, ""), ran.err
        return ran.out

    return call


def read_json(path):
    return json.loads(path.read_text())


def test_an_evaluation_counts_every_labelled_pixel(run, tmp_path):
    out = run("eval", "--variant", "base", "--set", "sections.overlap=2", "--quiet", "--json", tmp_path / "report.json")
    report = read_json(tmp_path / "report.json")
    (row,) = report["rows"]
    assert (report["dataset"], report["over"], row["variant"]) == ("still", "still", "base")
    assert row["sequences"] == {"pan": HAND_COUNT} and row["mean"] == HAND_COUNT
    assert re.search(r"pan +│ +2\.08 │ +33\.33", out) and re.search(r"mean +│ +2\.08 │ +33\.33", out)
    assert "false pixels %" in out and "Fu" not in out


def test_saved_masks_are_scored_in_the_same_way(moseg, root, masks, tmp_path):
    data = ("--dataset", "still", "--root", root, "--sequences", "pan", "--predictions", masks)
    ran = moseg("score", *data, "--json", tmp_path / "report.json", "--quiet")
    assert (ran.code, ran.err) == (0, "")
    report = read_json(tmp_path / "report.json")
    assert report["rows"][0]["mean"] == HAND_COUNT and report["matching"] == {"pan": "name"}
    (masks / "pan" / "00005.png").unlink()
    ran = moseg("score", *data, "--quiet")
    assert ran.code == 2 and "00005" in ran.err


def test_an_ablation_and_its_report_compare_variants(run, pages, tmp_path):
    out = run("ablate", "--quiet", "--json", tmp_path / "report.json", "--report", tmp_path / "page.html")
    rows = {row["variant"]: row["mean"] for row in read_json(tmp_path / "report.json")["rows"]}
    assert list(rows) == ["fused", "oc-depth", "oc", "trajs", "base"] and rows["base"] == HAND_COUNT
    assert "mean of 1 sequence" in out
    (page,) = pages
    means, *others = page.scores
    assert means.columns == ("variant", "false pixels %", "false frames %")
    # Four of the five find nothing.
    assert [table.title for table in others] == ["still, fused, oc-depth, oc, trajs", "still, base"]
    assert means.better == (Better.LESS, Better.LESS) and dict(means.rows)["base"] == tuple(HAND_COUNT.values())


def test_a_report_from_the_log_has_the_same_figures(run, moseg, pages, tmp_path):
    run("eval", "--variant", "base", "--quiet")
    ran = moseg("report", "latest", "--store", tmp_path / "store", "--out", tmp_path / "page.html")
    assert ran.code == 0, ran.err
    (table,) = pages[-1].scores
    assert dict(table.rows)["pan"] == tuple(HAND_COUNT.values())


def test_a_plan_and_a_contact_sheet_need_no_ground_truth(run, tmp_path):
    assert "score" in run("plan", "--variant", "base")
    run("contact-sheet", "--variant", "base", "--out", tmp_path / "sheets", "--quiet")
    assert (tmp_path / "sheets" / "pan.png").exists()


@pytest.mark.parametrize("command", ["eval", "plan"])
def test_the_true_number_of_motions_is_refused(moseg, root, tmp_path, command):
    data = ("--dataset", "still", "--root", root, "--sequences", "pan", "--store", tmp_path / "store")
    ran = moseg(command, *data, "--motions", "gt")
    assert ran.code == 2
    assert ran.err.splitlines()[-1].endswith("sequence pan; got --motions gt; expected --motions auto")
