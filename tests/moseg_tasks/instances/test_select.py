import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.instances import InstanceParams
from moseg.tasks.instances import select_instances


def boxes_as_masks(*boxes, size=(20, 30)):
    masks = np.zeros((len(boxes), *size), bool)
    for mask, (left, top, right, bottom) in zip(masks, boxes, strict=True):
        mask[top:bottom, left:right] = True
    return masks


def select(masks, scores, **params):
    return select_instances(masks, np.array(scores), InstanceParams(**params)).tolist()


def test_the_better_of_two_masks_of_one_object_is_kept():
    masks = boxes_as_masks((0, 0, 10, 10), (0, 0, 10, 9), (20, 0, 30, 10))
    assert select(masks, [0.4, 0.9, 0.5]) == [1, 2]
    assert select(masks, [0.9, 0.4, 0.5]) == [0, 2]


def test_of_equal_scores_the_first_is_better():
    assert select(boxes_as_masks((0, 0, 10, 10), (0, 0, 10, 9)), [0.5, 0.5]) == [0]


def test_overlap_up_to_the_limit_is_allowed():
    masks = boxes_as_masks((0, 0, 10, 10), (5, 0, 15, 10))
    assert select(masks, [0.5, 0.4], nms_iou=0.34) == [0, 1]
    assert select(masks, [0.5, 0.4], nms_iou=0.33) == [0]


def test_a_part_of_a_better_mask_is_dropped():
    masks = boxes_as_masks((0, 0, 10, 10), (1, 1, 4, 4))
    assert select(masks, [0.9, 0.4]) == [0]
    assert select(masks, [0.9, 0.4], containment=1) == [0, 1]


def test_a_worse_mask_around_better_ones_is_kept():
    assert select(boxes_as_masks((0, 0, 10, 10), (1, 1, 4, 4)), [0.4, 0.9]) == [1, 0]


def test_specks_and_background_are_dropped():
    masks = boxes_as_masks((0, 0, 30, 20), (0, 0, 5, 6), (10, 10, 11, 11), (0, 0, 0, 0))
    assert select(masks, [0.9, 0.8, 0.7, 0.6], min_area=0.01) == [1]
    assert select(masks, [0.9, 0.8, 0.7, 0.6], min_area=0, max_area=1, containment=1) == [0, 1, 2]


def test_background_drops_no_object_within_it():
    assert select(boxes_as_masks((0, 0, 30, 20), (0, 0, 5, 6)), [0.9, 0.8]) == [1]


def test_the_best_masks_are_kept_where_there_are_too_many():
    masks = boxes_as_masks(*((5 * n, 0, 5 * n + 5, 5) for n in range(6)))
    assert select(masks, [0.1, 0.5, 0.3, 0.9, 0.2, 0.4], max_objects=3) == [3, 1, 5]


def test_no_masks_leave_none():
    assert select(np.zeros((0, 5, 5), bool), []) == []


def test_scores_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="not one score for each mask"):
        select(boxes_as_masks((0, 0, 10, 10)), [0.1, 0.2])


def test_areas_that_leave_nothing_are_refused():
    with pytest.raises(ValidationError, match="min_area must be under max_area"):
        InstanceParams(min_area=0.5, max_area=0.5)


masks_and_scores = st.lists(
    st.tuples(st.integers(0, 9), st.integers(0, 9), st.integers(1, 10), st.integers(1, 10), st.floats(0, 1)), max_size=8
)


@given(masks_and_scores, st.randoms())
def test_the_order_of_masks_of_different_scores_does_not_matter(found, random):
    found = list({score: (x, y, x + width, y + height, score) for x, y, width, height, score in found}.values())
    shuffled = random.sample(found, len(found))
    results = []
    for some in (found, shuffled):
        kept = select(boxes_as_masks(*(entry[:4] for entry in some)), [entry[4] for entry in some], min_area=0)
        results.append([some[index] for index in kept])
    assert results[0] == results[1]
