import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.motion_prompts import MotionPromptParams
from moseg.tasks.instances.motion_prompts import choose_masks, prompts_of_regions

SIZE = (60, 80)


def labels_of(*boxes):
    labels = np.zeros(SIZE, np.uint16)
    for label, (left, top, right, bottom) in enumerate(boxes, start=1):
        labels[top:bottom, left:right] = label
    return labels


def prompt(labels, is_moving=None, **params):
    is_moving = [True] * int(labels.max()) if is_moving is None else is_moving
    return prompts_of_regions(labels, np.array(is_moving, bool), MotionPromptParams(**params))


def choose(masks, quality, labels, **params):
    region, chosen = choose_masks(
        np.array(masks), np.array(quality, float), prompt(labels), MotionPromptParams(**params)
    )
    return dict(zip(region.tolist(), chosen.tolist(), strict=True))


def test_the_box_holds_the_region_and_a_margin():
    prompts = prompt(labels_of((20, 10, 40, 30)), trimmed=0, margin=0.1)
    np.testing.assert_allclose(prompts.boxes, [[18, 8, 42, 32]])
    assert prompts.boxes.dtype == np.float32 and prompts.source.tolist() == [1]


def test_the_margin_ends_at_the_border_of_the_frame():
    np.testing.assert_allclose(prompt(labels_of((0, 0, 80, 30)), trimmed=0, margin=0.5).boxes, [[0, 0, 80, 45]])


def test_strays_do_not_widen_the_box():
    labels = labels_of((20, 10, 40, 30))
    labels[55, 75] = 1
    np.testing.assert_allclose(prompt(labels, margin=0).boxes, [[20, 10, 40, 30]])
    np.testing.assert_allclose(prompt(labels, trimmed=0, margin=0).boxes, [[20, 10, 76, 56]])


def test_the_first_point_is_farthest_from_the_border():
    # A bar with a square at its end: the square's centre has most room.
    labels = labels_of((5, 20, 40, 25))
    labels[10:35, 40:65] = 1
    assert prompt(labels, num_points=1).points.tolist() == [[[52, 22]]]


def test_the_border_of_the_frame_is_a_border():
    assert prompt(labels_of((0, 0, 21, 21)), num_points=1).points.tolist() == [[[10, 10]]]


def test_points_are_spread():
    (points,) = prompt(labels_of((10, 20, 70, 40)), num_points=3).points
    apart = [np.hypot(*(points[i] - points[j])) for i in range(3) for j in range(i)]
    assert min(apart) > 9


def test_a_region_of_one_pixel_has_the_same_point_again():
    prompts = prompt(labels_of((7, 9, 8, 10)), num_points=2, min_area=1e-9)
    assert prompts.points.tolist() == [[[7, 9], [7, 9]]]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5))
def test_every_point_lies_in_its_region_and_in_its_box(seed, num_points):
    rng = np.random.default_rng(seed)
    labels = np.kron(rng.integers(0, 4, (6, 8)), np.ones((10, 10), int)).astype(np.uint16)
    prompts = prompt(labels, num_points=num_points)
    for number, (box, points) in enumerate(zip(prompts.boxes, prompts.points, strict=True), start=1):
        xs, ys = points.astype(int).T
        assert (prompts.labels[ys, xs] == number).all()
        assert (labels[ys, xs] == prompts.source[number - 1]).all()
        left, top, right, bottom = box
        assert min(left, top) >= 0 and left < right <= SIZE[1] and top < bottom <= SIZE[0]


def test_static_and_small_regions_prompt_nothing():
    labels = labels_of((0, 0, 20, 20), (30, 0, 50, 20), (60, 0, 62, 2))
    prompts = prompt(labels, [False, True, True], min_area=0.01)
    assert prompts.source.tolist() == [2]
    np.testing.assert_array_equal(prompts.labels, labels == 2)


def test_no_regions_give_no_prompts():
    prompts = prompt(np.zeros(SIZE, np.uint16), [], num_points=4)
    assert prompts.boxes.shape == (0, 4) and prompts.points.shape == (0, 4, 2)


def test_a_label_without_evidence_is_refused():
    with pytest.raises(InputError, match="a region without evidence; got 2; expected labels up to 1"):
        prompt(labels_of((0, 0, 20, 20), (30, 0, 50, 20)), [True])


def test_the_best_of_the_masks_that_fit_is_chosen():
    labels = labels_of((20, 20, 40, 40))
    part, whole, scene = (labels_of(box) > 0 for box in ((20, 20, 24, 24), (18, 16, 42, 48), (0, 0, 80, 60)))
    assert choose([[part, whole, scene]], [[0.9, 0.7, 0.95]], labels) == {0: 1}
    assert choose([[part, whole, scene]], [[0.9, 0.7, 0.95]], labels, min_coverage=0.01) == {0: 0}
    assert choose([[part, whole, scene]], [[0.9, 0.7, 0.95]], labels, max_growth=20) == {0: 2}


def test_a_region_without_a_mask_that_fits_is_dropped():
    labels = labels_of((0, 0, 20, 20), (40, 0, 60, 20))
    elsewhere, fits = labels_of((60, 40, 80, 60)) > 0, labels_of((40, 0, 60, 20)) > 0
    empty = np.zeros(SIZE, bool)
    assert choose([[elsewhere, empty], [elsewhere, fits]], [[0.9, 0.9], [0.9, 0.1]], labels) == {1: 1}
    assert choose([[empty], [empty]], [[0.9], [0.9]], labels, min_coverage=0) == {}
