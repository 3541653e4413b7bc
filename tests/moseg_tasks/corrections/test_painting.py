import numpy as np
import pytest

from moseg.schemas.corrections import Corrections
from moseg.tasks.corrections.painting import Brush, brushes_of, paint_pixels
from moseg.tasks.corrections.relabel import UNTOUCHED, label_tables, relabel_section
from moseg.tasks.corrections.replay import replay_steps
from moseg.tasks.corrections.steps import AGE, read_steps, recipe_steps, steps_of

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
    """Return the labels of a section whose object n is n, after strokes of some of them."""
    edits = edits_of(*(stroke("paint", object=number) for number in range(1, 10)))
    tables = label_tables(replay_steps(steps_of(edits), dict.fromkeys(range(1, 10), 1), len(masks)))
    return relabel_section(masks.astype(np.uint16), np.arange(10), tables, 0, *painted)


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


def edits_of(*edits):
    return Corrections.model_validate({"edits": edits}).edits


def brushes(*edits):
    return brushes_of(edits_of(*edits))


def stroke(kind, frame=0, **values):
    return {kind: {"frame": frame, "strokes": STROKES, **values}}


def test_brushes_are_those_of_edits_with_pixels():
    found = brushes({"drop": 1}, stroke("paint", object=2), stroke("erase"), stroke("erase", object=2))
    assert found == {1: Brush(2), 2: Brush(0, True), 3: Brush(2, True)}


def test_strokes_have_another_number_after_a_merge_or_split_of_their_object():
    painted, erased = stroke("paint", object=3), stroke("erase", object=3)
    assert brushes(painted, {"merge": [3, 2]}, erased) == {0: Brush(3), 2: Brush(3 + AGE, True)}
    assert brushes(painted, split(3, 4), erased) == {0: Brush(3), 2: Brush(3 + AGE, True)}
    assert brushes(painted, {"merge": [5, 2]}, erased) == {0: Brush(3), 2: Brush(3, True)}


def corrected(*edits, row=(0, 3, 5, 3)):
    """Return labels (frame, column) of objects 3 and 5 after edits; strokes are pairs with their columns.

    The recipe of the edits has the same labels.
    """
    pixels = [at(*edit[1]) for edit in edits if isinstance(edit, tuple)]
    given = edits_of(*(edit[0] if isinstance(edit, tuple) else edit for edit in edits))
    painted = paint_pixels([(0, mask) for mask in pixels], list(brushes_of(given).values()), SHAPE)
    masks = np.broadcast_to(np.array(row, np.uint16), SHAPE)
    labels = []
    for steps in (steps_of(given), read_steps(recipe_steps(given))):
        tables = label_tables(replay_steps(steps, {3: 1, 5: 2}, len(masks)))
        labels.append(relabel_section(masks, np.arange(6), tables, 0, *painted)[:, 0].tolist())
    assert labels[0] == labels[1]
    return labels[0]


def split(identity, frame, into=None):
    return {"split": {"object": identity, "frame": frame} | ({} if into is None else {"into": into})}


def erase(identity, *columns):
    return stroke("erase", object=identity), columns


def brush(identity, *columns):
    return stroke("paint", object=identity), columns


def test_what_is_merged_after_erasing_stays():
    assert corrected(erase(3, 1, 2), {"merge": [3, 5]}) == [[0, 0, 3, 3]] * 3
    assert corrected(erase(3, 1, 2), {"merge": [5, 3]}) == [[0, 0, 5, 5]] * 3
    assert corrected(brush(5, 1, 2), erase(3, 1, 2, 3), {"merge": [3, 5]}) == [[0, 3, 3, 0]] * 3


def test_what_is_merged_before_erasing_goes():
    assert corrected({"merge": [3, 5]}, erase(3, 1, 2)) == [[0, 0, 0, 3]] * 3
    assert corrected(brush(5, 0), {"merge": [3, 5]}, erase(3, 0, 1)) == [[0, 0, 3, 3]] * 3


def test_erasing_what_was_split_off_without_a_number_erases_what_was_painted_of_it():
    assert corrected(brush(3, 0), split(3, 1), erase(6, 0, 1)) == [[3, 3, 5, 3], [0, 0, 5, 6], [0, 0, 5, 6]]


def test_erasing_a_part_of_a_split_object_erases_it_in_its_frames_alone():
    painted, cut = brush(3, 0), split(3, 1, 7)
    late, early = [[3, 3, 5, 3], [0, 0, 5, 7], [0, 0, 5, 7]], [[0, 0, 5, 3], [7, 7, 5, 7], [7, 7, 5, 7]]
    assert corrected(painted, cut, erase(7, 0, 1)) == late
    assert corrected(painted, cut, erase(3, 0, 1)) == early
    assert corrected(painted, cut, erase(7, 0, 1), erase(3, 0, 1)) == [[0, 0, 5, 3], [0, 0, 5, 7], [0, 0, 5, 7]]


def test_what_is_split_after_erasing_is_erased_in_all_frames():
    assert corrected(erase(3, 1), split(3, 1, 7)) == [[0, 0, 5, 3], [0, 0, 5, 7], [0, 0, 5, 7]]
    assert corrected(brush(3, 0, 1), erase(3, 1), split(3, 1, 7)) == [[3, 0, 5, 3], [7, 0, 5, 7], [7, 0, 5, 7]]


def test_painting_and_erasing_again_after_a_split_and_a_merge():
    edits = [split(3, 1, 7), brush(7, 0), erase(3, 0, 1), {"merge": [7, 5]}, erase(7, 2)]
    # Column 0 is 7 in all frames, for it was painted so; column 2 is 5, which is 7 by then.
    assert corrected(*edits) == [[7, 0, 0, 3], [7, 7, 0, 7], [7, 7, 0, 7]]


def drawn(rng, objects):
    """Return an edit of one of the objects that there are, at random, and what it does to labels in its pixels."""
    one, frame, late = int(rng.choice(sorted(objects))), int(rng.integers(1, 6)), np.arange(6)[:, None, None]
    kind = rng.choice(["paint", "erase", "erase", "merge", "split"])
    if kind == "paint":
        one = int(rng.integers(1, 9))
        objects.add(one)
        return stroke("paint", object=one), lambda labels, mask: np.where(mask, one, labels)
    if kind == "erase":
        return stroke("erase", object=one), lambda labels, mask: np.where(mask & (labels == one), 0, labels)
    if kind == "merge" and len(objects) > 1:
        other = int(rng.choice(sorted(objects - {one})))
        objects.remove(other)
        return {"merge": [one, other]}, lambda labels, _: np.where(labels == other, one, labels)
    into = max(objects) + 1 if rng.random() < 0.5 else next(each for each in range(1, 99) if each not in objects)
    edit = split(one, frame, None if into == max(objects) + 1 else into)
    objects.add(into)
    return edit, lambda labels, _: np.where((labels == one) & (late >= frame), into, labels)


@pytest.mark.parametrize("seed", range(100))
def test_labels_are_those_of_edits_done_to_the_pixels_one_after_the_other(seed):
    rng, objects = np.random.default_rng(seed), {1, 2, 3}
    masks = rng.integers(0, 4, (6, 1, 40)).astype(np.uint16)
    wanted, edits, pixels = masks, [], []
    for _ in range(10):
        edit, change = drawn(rng, objects)
        mask = rng.random(masks.shape) < 0.4
        wanted = change(wanted, mask)
        edits.append(edit)
        pixels.append(mask)
    given = edits_of(*edits)
    brushes = brushes_of(given)
    painted = paint_pixels([(0, pixels[index]) for index in brushes], list(brushes.values()), masks.shape)
    tables = label_tables(replay_steps(steps_of(given), {1: 1, 2: 2, 3: 3}, len(masks)))
    np.testing.assert_array_equal(relabel_section(masks, np.arange(4), tables, 0, *painted), wanted)
