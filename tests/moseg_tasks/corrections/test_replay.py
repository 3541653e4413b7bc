"""Replay of edits: which objects there are then, which are shown, and which of them each pixel belongs to."""

import numpy as np
import pytest

from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import InputError
from moseg.tasks.corrections.names import names_of
from moseg.tasks.corrections.relabel import (
    label_table,
    label_tables,
    labels_at,
    members_at,
    motion_array,
    relabel_section,
)
from moseg.tasks.corrections.replay import replay_steps
from moseg.tasks.corrections.steps import AGE, read_steps, recipe_steps, steps_of

MOTIONS = {1: 1, 2: 2, 3: 0, 4: 1}
STROKES = [{"radius": 1, "points": [[1, 1]]}]


def _edits(*edits):
    return Corrections.model_validate({"edits": edits}).edits


def _replay(*edits, motions=MOTIONS, num_frames=20):
    return replay_steps(steps_of(_edits(*edits)), motions, num_frames)


def _paint(identity, frame=0, kind="paint"):
    return {kind: {"object": identity, "frame": frame, "strokes": STROKES}}


def _split(identity, frame, into=None):
    return {"split": {"object": identity, "frame": frame} | ({} if into is None else {"into": into})}


@pytest.mark.parametrize(
    ("edits", "motions", "shown"),
    [
        ([], MOTIONS, {1, 2, 4}),
        ([{"drop": 1}], MOTIONS, {2, 4}),
        ([{"drop": 1}, {"keep": 1}], MOTIONS, {1, 2, 4}),
        ([{"keep": 3}], MOTIONS | {3: 3}, {1, 2, 3, 4}),
        ([{"keep": 2}], MOTIONS, {1, 2, 4}),
        ([{"static": 2}], MOTIONS | {2: 0}, {1, 4}),
        ([{"static": 2}, {"keep": 2}], MOTIONS, {1, 2, 4}),
        ([{"moving": 4}], MOTIONS | {4: 3}, {1, 2, 4}),
        ([{"merge": [3, 2]}], {1: 1, 3: 2, 4: 1}, {1, 3, 4}),
        ([{"drop": 1}, {"merge": [1, 4]}], {1: 1, 2: 2, 3: 0}, {1, 2}),
        ([{"static": 1}, {"merge": [1, 3]}], {1: 0, 2: 2, 4: 1}, {2, 4}),
        ([_split(2, 5)], MOTIONS | {5: 2}, {1, 2, 4, 5}),
        ([{"drop": 2}, _split(2, 5, 9), {"keep": 9}], MOTIONS | {9: 2}, {1, 4, 9}),
        ([_paint(2)], MOTIONS, {1, 2, 4}),
        ([_paint(7)], MOTIONS | {7: 3}, {1, 2, 4, 7}),
        ([_paint(2, kind="erase")], MOTIONS, {1, 2, 4}),
    ],
)
def test_objects_after_edits(edits, motions, shown):
    found = _replay(*edits)
    assert (found.motions, found.shown) == (motions, shown)


def test_runs_follow_merges_and_splits_in_their_order():
    assert _replay(_split(2, 5, 7)).runs[2] == [(0, 2), (5, 7)]
    assert _replay(_split(2, 5, 7), _split(2, 3, 8)).runs[2] == [(0, 2), (3, 8), (5, 7)]
    assert _replay(_split(2, 5, 7), _split(7, 9, 8)).runs[2] == [(0, 2), (5, 7), (9, 8)]
    assert _replay(_split(2, 5, 7), _split(7, 3, 8)).runs[2] == [(0, 2), (5, 8)]
    assert _replay(_split(2, 5, 7), {"merge": [1, 7]}).runs == {
        1: [(0, 1)],
        2: [(0, 2), (5, 1)],
        3: [(0, 3)],
        4: [(0, 4)],
    }
    assert _replay(_split(2, 5, 7), {"merge": [2, 7]}).runs[2] == [(0, 2)]
    assert _replay({"merge": [1, 2]}, _split(1, 5, 2)).runs[2] == [(0, 1), (5, 2)]


def test_strokes_follow_the_merges_and_splits_after_them_alone():
    found = _replay(_paint(2), {"merge": [1, 2]}, _split(1, 5, 7))
    assert found.stroke_runs == {2: [(0, 1), (5, 7)]}
    # From the split on, 2 is painted where the user says so, before it not.
    found = _replay(_paint(2, 3), _split(2, 5, 7), _paint(2, 9), _paint(7, 9))
    assert found.stroke_runs == {2: [(0, 2), (5, 7)], 2 + AGE: [(0, 2)], 7: [(0, 7)]}
    # A number that a merge made free is another object when it is painted again.
    found = _replay({"merge": [1, 2]}, _paint(2))
    assert found.stroke_runs == {2 + AGE: [(0, 2)]}
    assert found.runs[2] == [(0, 1)] and found.motions[2] == 2


def test_more_strokes_of_an_object_and_names_change_no_recipe():
    edits = [{"drop": 1}, _paint(7, 3)]
    more = [{"rename": {"object": 1, "name": "x"}}, *edits, _paint(7, 9), {"erase": {"frame": 2, "strokes": STROKES}}]
    assert recipe_steps(_edits(*more)) == recipe_steps(_edits(*edits))
    assert recipe_steps(_edits(*edits)) == [
        {"kind": "drop", "objects": [1]},
        {"kind": "paint", "objects": [7], "number": 7},
    ]


def test_steps_of_a_recipe_do_what_the_edits_do():
    edits = [_split(2, 5), {"merge": [1, 4]}, _paint(9, 3), {"static": 1}, _paint(2, 3, "erase"), {"drop": 9}]
    assert replay_steps(read_steps(recipe_steps(_edits(*edits))), MOTIONS, 20) == _replay(*edits)


@pytest.mark.parametrize(
    ("edits", "line"),
    [
        ([{"drop": 9}], r"no such object in edit 1 \(drop\); got 9; expected one of 1, 2, 3, 4"),
        ([{"merge": [1, 2]}, {"keep": 2}], r"no such object in edit 2 \(keep\); got 2; expected one of 1, 3, 4"),
        ([{"rename": {"object": 9, "name": "x"}}], r"edit 1 \(rename\); got 9"),
        ([_paint(9, 3, "erase")], r"edit 1 \(erase\); got 9"),
        ([_split(2, 5, 3)], r"a number in use in edit 1 \(split\); got 3; expected a number not in use, such as 5"),
        ([_split(2, 20)], r"no such frame in edit 1 \(split\); got 20; expected 0 to 19"),
        ([_paint(2, 20)], r"no such frame in edit 1 \(paint\); got 20; expected 0 to 19"),
    ],
)
def test_an_edit_of_what_is_not_there_is_refused(edits, line):
    with pytest.raises(InputError, match=line):
        _replay(*edits)


def test_errors_name_the_given_place_and_a_few_of_many_objects():
    with pytest.raises(InputError, match=r"in fixes\.yaml: edit 4; got 99; expected one of 1, .*, 12 and 8 more"):
        replay_steps(steps_of(_edits({"drop": 99})), dict.fromkeys(range(1, 21), 1), 5, ["fixes.yaml: edit 4"])
    with pytest.raises(InputError, match="expected none: nothing was found"):
        replay_steps(steps_of(_edits({"drop": 1})), {}, 5)


def test_the_largest_number_is_not_passed():
    found = replay_steps(steps_of(_edits(_split(65535, 2))), {65535: 1, 1: 0}, 5)
    assert set(found.motions) == {1, 2, 65535}


def test_tables_have_labels_of_shown_objects_alone():
    found = _replay({"drop": 1}, _split(2, 5, 7))
    table = label_table(found.runs, found.shown)
    assert table.dtype == np.int32
    assert table.tolist() == [[1, 0, 0], [2, 0, 2], [2, 5, 7], [3, 0, 0], [4, 0, 4]]
    assert labels_at(table, 4) == {1: 0, 2: 2, 3: 0, 4: 4}
    assert labels_at(table, 5)[2] == 7
    assert label_table({}, frozenset()).shape == (0, 3)
    assert motion_array(found).tolist() == [0, 1, 2, 0, 1, 0, 0, 2]


def test_a_section_is_relabelled_by_its_own_frames():
    found = _replay({"static": 4}, _split(2, 11, 7), {"merge": [1, 7]})
    masks = np.array([[[0, 1, 2, 3]]] * 3, np.uint16)
    labels = relabel_section(masks, np.array([0, 2, 4, 1]), label_tables(found), 10)
    assert labels.dtype == np.uint16
    assert labels[:, 0].tolist() == [[0, 2, 0, 1], [0, 1, 0, 1], [0, 1, 0, 1]]


def test_strokes_lie_over_the_objects_and_erase_all_or_one_of_them():
    found = _replay(_paint(9), {"merge": [2, 9]}, {"drop": 1}, _paint(2, kind="erase"))
    number = 2 + AGE
    masks = np.array([[[1, 1, 1, 2, 2, 2, 0]]], np.uint16)
    painted = np.array([[[-1, 9, 0, -1, 0, -2, 9]]], np.int32)
    labels = relabel_section(masks, np.array([0, 1, 2]), label_tables(found), 0, painted, ((-1, number),))
    assert labels[0, 0].tolist() == [0, 2, 0, 2, 0, 0, 2]


def test_an_erased_object_leaves_others_as_they_are():
    found = _replay(_paint(1, kind="erase"))
    painted = np.full((1, 1, 3), -2, np.int32)
    masks = np.array([[[0, 1, 2]]], np.uint16)
    labels = relabel_section(masks, np.arange(3), label_tables(found), 0, painted, ((-1, 1),))
    assert labels[0, 0].tolist() == [0, 0, 2]


def test_strokes_know_what_their_object_is_made_of_when_they_are_made():
    found = _replay(_paint(2), _split(2, 5, 7), {"merge": [4, 7]}, _paint(4, kind="erase"), {"merge": [4, 1]})
    number = 4 + AGE
    assert found.members == {2: [(2, 0, 20)], number: [(2, 5, 20), (4, 0, 20)]}
    assert found.stroke_members == {2: [(2, 0, 20)], number: [(2, 5, 20), (number, 0, 20)]}
    table = label_tables(found).members
    assert table.dtype == np.int32
    assert members_at(table, [number], 4) == [4] and members_at(table, [number], 5) == [2, 4]
    assert label_tables(_replay()).members.shape == (0, 4)


def _name(identity, text):
    return {"rename": {"object": identity, "name": text}}


def test_names_follow_merges():
    assert names_of(_edits(_name(1, "a"), _name(1, "b"), _name(2, "c"))) == {1: "b", 2: "c"}
    assert names_of(_edits(_name(1, "a"), _name(2, "c"), {"merge": [1, 2]})) == {1: "a"}
    assert names_of(_edits(_name(2, "c"), {"merge": [1, 2]})) == {1: "c"}
    assert names_of(_edits(_name(2, "c"), _split(2, 5, 7))) == {2: "c"}
