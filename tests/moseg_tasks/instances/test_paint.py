import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from moseg.schemas.errors import InputError
from moseg.tasks.instances import paint_instances


def test_objects_are_numbered_by_falling_score():
    masks = np.zeros((3, 1, 6), bool)
    masks[0, 0, :2] = masks[1, 0, 2:4] = masks[2, 0, 4:] = True
    labels, order = paint_instances(masks, np.array([0.2, 0.9, 0.5]))
    assert labels.tolist() == [[3, 3, 1, 1, 2, 2]]
    assert order.tolist() == [1, 2, 0] and labels.dtype == np.uint16


def test_shared_pixels_go_to_the_smaller_object():
    masks = np.zeros((2, 1, 6), bool)
    masks[0], masks[1, 0, :2] = True, True
    for scores in ([0.9, 0.1], [0.1, 0.9]):
        labels, order = paint_instances(masks, np.array(scores))
        assert order[labels[0] - 1].tolist() == [1, 1, 0, 0, 0, 0]


def test_shared_pixels_of_equal_areas_go_to_the_better_object():
    masks = np.array([[[1, 1, 0]], [[0, 1, 1]]], bool)
    assert paint_instances(masks, np.array([0.1, 0.9])).labels.tolist() == [[2, 1, 1]]
    assert paint_instances(masks, np.array([0.9, 0.1])).labels.tolist() == [[1, 1, 2]]


def test_a_mask_hidden_by_others_is_not_an_object():
    masks = np.array([[[1, 1, 1, 1]], [[1, 1, 0, 0]], [[0, 0, 1, 1]]], bool)
    labels, order = paint_instances(masks, np.array([0.9, 0.8, 0.7]))
    assert labels.tolist() == [[1, 1, 2, 2]] and order.tolist() == [1, 2]


def test_no_masks_paint_nothing():
    labels, order = paint_instances(np.zeros((0, 3, 4), bool), np.zeros(0))
    assert labels.shape == (3, 4) and not labels.any() and order.shape == (0,)


def test_scores_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="not one score for each mask"):
        paint_instances(np.ones((2, 3, 4), bool), np.zeros(1))


@given(hnp.arrays(bool, st.tuples(st.integers(0, 5), st.just(3), st.just(4))), st.integers(0, 2**32 - 1))
def test_each_painted_pixel_is_in_its_objects_mask_and_none_is_left_out(masks, seed):
    scores = np.random.default_rng(seed).random(len(masks))
    labels, order = paint_instances(masks, scores)
    assert ((labels > 0) == masks.any(axis=0)).all()
    assert np.unique(labels[labels > 0]).tolist() == list(range(1, len(order) + 1))
    for label, index in enumerate(order, start=1):
        assert masks[index][labels == label].all()
    assert (np.diff(scores[order]) <= 0).all()


def test_a_partly_hidden_mask_is_an_object_only_if_enough_is_left():
    masks = np.zeros((3, 4, 10), bool)
    masks[0, :, :3], masks[1, :, 4:7] = True, True
    masks[2] = masks[0] | masks[1]
    masks[2, 0, 9] = True
    scores = np.array([0.9, 0.8, 0.7])
    assert paint_instances(masks, scores).order.tolist() == [0, 1, 2]
    labels, order = paint_instances(masks, scores, min_area=2 / 40)
    assert order.tolist() == [0, 1] and labels.max() == 2
