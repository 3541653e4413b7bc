"""The table of objects has a line for each object and frame, and says whether the object moves now."""

import csv

import numpy as np
import pytest

from moseg.workflows.exports import summarise_sequence, write_motion
from moseg.workflows.exports.formats.object_table import write_csv
from moseg.workflows.exports.saved_segmentation import open_segmentation
from moseg.workflows.exports.summarise import runs_of
from moseg.workflows.exports.write_masks import write_masks


def save(folder, labels, moves=None, confidences=None):
    write_masks(folder / "masks", iter(labels))
    summary = summarise_sequence("clip", labels, 24.0, 2, {1: 1}, moves=moves, confidences=confidences)
    write_motion(folder / "motion.json", summary)
    return open_segmentation(folder)


def rows(saved, folder):
    with (write_csv(saved, folder) / "objects.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture
def labels():
    labels = np.zeros((4, 20, 30), np.uint16)
    for t in (0, 1, 3):
        labels[t, 5:9, 10 + t : 16 + t] = 1
    return labels


def test_a_line_says_where_an_object_is_and_whether_it_moves(tmp_path, labels):
    moves = [np.array([-1, 1], np.int8), np.array([-1, 0], np.int8), np.array([-1, -1], np.int8)]
    found = rows(save(tmp_path, labels, [*moves, moves[0]]), tmp_path)
    assert [(row["frame"], row["moves_now"]) for row in found] == [("0", "1"), ("1", "0"), ("3", "1")]
    assert {name: found[1][name] for name in ("identity", "left", "top", "right", "bottom", "pixels")} == {
        "identity": "1",
        "left": "11",
        "top": "5",
        "right": "16",
        "bottom": "8",
        "pixels": "24",
    }


def test_a_line_says_how_sure_and_how_complete_its_mask_is(tmp_path, labels):
    confidences = [(np.array([np.nan, 0.9 - 0.1 * t]), np.array([np.nan, 0.5])) for t in range(4)]
    found = rows(save(tmp_path, labels, confidences=confidences), tmp_path)
    assert [(row["sure"], row["complete"]) for row in found] == [("0.9", "0.5"), ("0.8", "0.5"), ("0.6", "0.5")]


def test_a_line_has_the_name_of_its_object(write_saved, tmp_path):
    found = rows(write_saved(tags={2: "dog", 7: "cat"}, given_names={2: 'Rex, "the dog"'}), tmp_path)
    assert {(row["identity"], row["name"]) for row in found} == {("2", 'Rex, "the dog"'), ("7", "cat")}


def test_it_is_left_open_where_it_is_not_known(tmp_path, labels):
    for row in rows(save(tmp_path, labels), tmp_path):
        assert {row[name] for name in ("moves_now", "sure", "complete", "name")} == {""}


def test_runs_are_of_consecutive_frames():
    assert runs_of([0, 1, 2, 5, 7, 8]) == ((0, 2), (5, 5), (7, 8)) and runs_of([]) == ()
