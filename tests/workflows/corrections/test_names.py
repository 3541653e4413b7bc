"""The names that a user gives objects, in exports, overlays and reports."""

import json

import numpy as np
import pytest

from moseg.store import open_store
from moseg.workflows.api import segment_video
from moseg.workflows.exports import OverlayStyle
from moseg.workflows.reports.from_log import report_run


def test_the_users_names_are_in_exports_and_doubts(moseg, in_empty_folder, correct):
    strokes = [{"radius": 6, "points": [[20, 20]]}]
    edits = [{"paint": {"object": 9, "frame": 5, "strokes": strokes}}, {"rename": {"object": 9, "name": "kite, red"}}]
    result = correct(edits)
    result.save("out")
    # Nothing moves where it was painted, and no option changes that.
    (doubt,) = [line for line in result.look_at if line.startswith("object 9")]
    assert doubt.startswith("object 9 (kite, red) ") and "--" not in doubt
    assert moseg("export", "out", "--to", "coco").code == 0
    with open("out/coco.json") as file:
        assert {each["name"] for each in json.load(file)["categories"]} == {"kite, red", "moving object"}


def test_an_overlay_has_the_users_names(correct):
    style = OverlayStyle(has_identities=True)
    plain, named = (correct(edits) for edits in ([], [{"rename": {"object": 1, "name": "A"}}]))
    assert not np.array_equal(plain.overlay(0, style), named.overlay(0, style))
    np.testing.assert_array_equal(plain.overlay(0), named.overlay(0))


@pytest.fixture
def report_panel(frames, tmp_path, config):
    """Function that corrects the squares in a new store, and returns their part of the report of the run's log."""

    def report(corrections):
        folder = tmp_path / "store"
        options = {"store": folder, "progress": False, "keep_cues": True, "name": "corrected"}
        segment_video(frames, config, corrections=corrections, **options)
        (panel,) = report_run(open_store(str(folder), create=False), "latest").sequences
        return panel

    return report


def test_the_report_of_a_run_from_its_log_has_the_corrected_objects(report_panel, several_edits):
    panel = report_panel(several_edits)
    assert [(row.identity, row.tag) for row in panel.objects] == [(2, None), (4, "late")]


def test_a_report_compares_objects_by_the_users_names(report_panel):
    panel = report_panel([{"rename": {"object": 1, "name": "kite"}}])
    labels = {label for variant in panel.variants for matrix in variant.matrices for label in matrix.labels}
    assert labels == {"background", "1 kite", "2"}
