import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from moseg.tasks.detections import suppress_boxes

BOXES = np.array([[0, 0, 10, 10], [0, 0, 10, 8], [20, 0, 30, 10]], float)


def iou(box0, box1):
    low, high = np.maximum(box0[:2], box1[:2]), np.minimum(box0[2:], box1[2:])
    shared = np.prod(np.maximum(high - low, 0))
    return shared / (np.prod(box0[2:] - box0[:2]) + np.prod(box1[2:] - box1[:2]) - shared)


def test_the_better_of_two_that_overlap_is_kept():
    assert suppress_boxes(BOXES, np.array([0.5, 0.9, 0.4]), 0.5).tolist() == [1, 2]
    assert suppress_boxes(BOXES, np.array([0.9, 0.5, 0.4]), 0.5).tolist() == [0, 2]


def test_of_equal_scores_the_first_is_better():
    assert suppress_boxes(BOXES, np.array([0.5, 0.5, 0.5]), 0.5).tolist() == [0, 2]


def test_overlap_up_to_the_limit_is_allowed():
    assert suppress_boxes(BOXES, np.array([0.5, 0.9, 0.4]), 0.8).tolist() == [1, 0, 2]


def test_boxes_of_different_groups_do_not_compete():
    assert suppress_boxes(BOXES, np.array([0.5, 0.9, 0.4]), 0.5, np.array([0, 1, 0])).tolist() == [1, 0, 2]


def test_no_boxes_leave_none():
    assert suppress_boxes(np.zeros((0, 4)), np.zeros(0), 0.5).shape == (0,)


corners = st.tuples(st.integers(0, 20), st.integers(0, 20), st.integers(1, 20), st.integers(1, 20))


@given(st.lists(st.tuples(corners, st.floats(0, 1)), max_size=12), st.floats(0, 1))
def test_kept_boxes_do_not_overlap_and_dropped_boxes_overlap_a_better_one(found, limit):
    boxes = np.array([(x, y, x + width, y + height) for (x, y, width, height), _ in found], float).reshape(-1, 4)
    scores = np.array([score for _, score in found])
    kept = suppress_boxes(boxes, scores, limit)
    assert (np.diff(scores[kept]) <= 0).all()
    for place, index in enumerate(kept):
        assert all(iou(boxes[index], boxes[other]) <= limit + 1e-9 for other in kept[:place])
    for index in set(range(len(boxes))) - set(kept.tolist()):
        better = [other for other in kept if scores[other] >= scores[index]]
        assert any(iou(boxes[index], boxes[other]) > limit - 1e-9 for other in better)
