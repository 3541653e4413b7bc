import numpy as np

from moseg.schemas.corrections import Corrections
from moseg.tasks.corrections.painting import Brush, brushes_of, paint_pixels
from moseg.tasks.corrections.relabel import UNTOUCHED, relabel_section
from moseg.tasks.corrections.steps import AGE

SHAPE = (3, 1, 4)
STROKES = [{"radius": 1, "points": [[0, 0]]}]


def at(*columns, frames=(0, 1, 2)):
    mask = np.zeros(SHAPE, bool)
    mask[np.ix_(frames, [0], columns)] = True
    return mask


def paint(*edits):
    return paint_pixels([(0, mask) for _, mask in edits], [brush for brush, _ in edits], SHAPE)


def test_later_edits_override_earlier_ones():
    painted, erased = paint((Brush(2), at(0, 1, 2)), (Brush(0, True), at(1)), (Brush(3), at(2, 3)))
    assert painted.dtype == np.int32 and erased == ()
    assert painted[1, 0].tolist() == [2, 0, 3, 3]
    assert paint((Brush(3), at(2, 3)), (Brush(2), at(0, 1, 2)))[0][0, 0].tolist() == [2, 2, 2, 3]


def test_what_no_edit_reaches_is_left():
    painted, _ = paint_pixels([(1, at(0)[:1])], [Brush(4)], SHAPE)
    assert painted[:, 0, 0].tolist() == [UNTOUCHED, 4, UNTOUCHED] and (painted[:, 0, 1:] == UNTOUCHED).all()


def labels(painted, masks):
    """Return the labels of a section whose object n is n, after what was painted."""
    table = np.array([(number, 0, number) for number in range(1, 10)], np.int32)
    given = painted.painted, painted.erased, table
    return relabel_section(masks.astype(np.uint16), np.arange(10), table, 0, *given)


def test_one_object_is_erased_and_others_stay():
    masks = np.broadcast_to(np.array([1, 2, 2, 3]), SHAPE)
    erased = paint((Brush(2, True), at(0, 1, 3)))
    assert labels(erased, masks)[0, 0].tolist() == [1, 0, 2, 3]


def test_two_objects_erased_at_the_same_place_are_both_gone():
    masks = np.broadcast_to(np.array([1, 2, 3, 1]), SHAPE)
    erased = paint((Brush(2, True), at(0, 1, 2)), (Brush(3, True), at(0, 1, 2)), (Brush(2, True), at(0, 1, 2)))
    assert labels(erased, masks)[0, 0].tolist() == [1, 0, 0, 1]


def test_erasing_an_object_erases_what_was_painted_of_it_and_not_of_others():
    masks = np.zeros(SHAPE)
    painted = paint((Brush(2), at(0, 1)), (Brush(3), at(2)), (Brush(2, True), at(0, 2)))
    assert labels(painted, masks)[0, 0].tolist() == [0, 2, 3, 0]


def test_painting_after_erasing_paints():
    masks = np.broadcast_to(np.array([1, 2, 2, 3]), SHAPE)
    painted = paint((Brush(2, True), at(1, 2)), (Brush(5), at(2)))
    assert labels(painted, masks)[0, 0].tolist() == [1, 0, 5, 3]


def brushes(*edits):
    return brushes_of(Corrections.model_validate({"edits": edits}).edits)


def stroke(kind, frame=0, **values):
    return {kind: {"frame": frame, "strokes": STROKES, **values}}


def test_brushes_are_those_of_edits_with_pixels():
    found = brushes({"drop": 1}, stroke("paint", object=2), stroke("erase"), stroke("erase", object=2))
    assert found == {1: Brush(2), 2: Brush(0, True), 3: Brush(2, True, (2,))}


def test_erasing_a_merged_object_erases_what_was_painted_of_its_parts():
    found = brushes(stroke("paint", object=3), {"merge": [2, 3]}, stroke("erase", object=2))
    assert found[2] == Brush(2 + AGE, True, (3,))


def test_erasing_what_was_split_off_erases_what_was_painted_before():
    split = {"split": {"object": 3, "frame": 4, "into": 7}}
    assert brushes(stroke("paint", object=3), split, stroke("erase", object=7))[2].same == (3,)
