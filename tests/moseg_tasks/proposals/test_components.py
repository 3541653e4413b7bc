import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import ComponentParams
from moseg.tasks.proposals import Components, keep_best, keep_parts, label_components, object_boxes

PARAMS = ComponentParams()
FRAMES, HEIGHT, WIDTH = 6, 40, 60


def empty(level: float = 0.1) -> np.ndarray:
    return np.full((FRAMES, HEIGHT, WIDTH), level, np.float32)


def find_components(foreground: np.ndarray, params: ComponentParams) -> Components:
    return keep_best(foreground, label_components(foreground, params), params)


def count(foreground: np.ndarray, **params) -> int:
    return len(find_components(foreground, ComponentParams(**params)).scores)


def test_two_movers_are_two_objects_followed_through_time_best_first():
    foreground, expected = empty(), np.zeros((FRAMES, HEIGHT, WIDTH), int)
    for t in range(FRAMES):
        foreground[t, 5:13, 5 + t : 13 + t], expected[t, 5:13, 5 + t : 13 + t] = 0.8, 2
        foreground[t, 20:34, 40 - t : 54 - t], expected[t, 20:34, 40 - t : 54 - t] = 0.95, 1
    components = find_components(foreground, PARAMS)
    np.testing.assert_array_equal(components.labels, expected)
    assert len(components.scores) == 2 and components.scores[0] > components.scores[1]


def test_objects_that_touch_at_one_time_are_one():
    foreground = empty()
    for t in range(FRAMES):
        foreground[t, 10:20, 5 + 3 * t : 15 + 3 * t] = 0.9
        foreground[t, 10:20, 45 - 3 * t : 55 - 3 * t] = 0.9
    assert count(foreground) == 1
    assert count(foreground[:3]) == 2


def test_within_a_frame_corners_touch_but_from_frame_to_frame_only_the_same_pixel():
    diagonal = empty()
    diagonal[:, 5:15, 5:15] = diagonal[:, 15:25, 15:25] = 0.9
    assert count(diagonal) == 1
    jump = empty()[:2]
    jump[0, 5:15, 5:15] = jump[1, 5:15, 15:25] = 0.9
    assert count(jump) == 2
    jump[1, 14, 14] = 0.9
    assert count(jump) == 1


def test_a_frame_without_it_ends_an_object():
    foreground = empty()
    foreground[:, 5:15, 5:15] = 0.9
    foreground[3] = 0.1
    components = find_components(foreground, PARAMS)
    np.testing.assert_array_equal(components.labels[:, 10, 10], [1, 1, 1, 0, 2, 2])


def test_the_score_is_the_soft_mass_of_a_component_inside_the_frame():
    foreground = empty()
    foreground[2:4, 10:20, 10:30] = 0.9
    np.testing.assert_allclose(find_components(foreground, PARAMS).scores, [2 * 10 * 20 * 0.9], rtol=1e-5)


def test_the_score_falls_with_the_share_of_the_outline_on_the_frame_s_border():
    inside, touching = empty(), empty()
    inside[:, 10:20, 10:30] = touching[:, :10, 10:30] = 0.9
    whole = find_components(inside, PARAMS).scores[0]
    lessened = find_components(touching, PARAMS).scores[0]
    outline = 2 * (10 + 20) - 4
    assert lessened / whole == pytest.approx(1 - 20 / outline / PARAMS.border_share)


@pytest.mark.parametrize("strip", [np.s_[:, -6:, :], np.s_[:, :6, :], np.s_[:, :, :6], np.s_[:, :, -6:], np.s_[:]])
def test_a_strip_along_the_border_and_the_whole_frame_are_no_objects(strip):
    foreground = empty()
    foreground[strip] = 0.95
    assert count(foreground) == 0


def test_objects_far_below_the_best_and_specks_are_dropped():
    foreground = empty()
    foreground[:, 5:25, 5:35] = 0.9
    foreground[:, 30:34, 45:49] = 0.7
    assert count(foreground) == 1
    assert count(foreground, score_ratio=0.01) == 2
    assert count(foreground, score_ratio=0.01, min_area=0.01) == 1


def test_the_least_area_is_of_the_frames_that_an_object_is_in():
    foreground = empty()
    foreground[2, 10:20, 10:20] = 0.9
    share = 100 / (HEIGHT * WIDTH)
    assert count(foreground, min_area=0.99 * share) == 1 and count(foreground, min_area=1.01 * share) == 0


def test_only_the_best_objects_are_kept_when_there_are_many():
    foreground = empty()
    for i in range(5):
        foreground[:, 4:12, 2 + 11 * i : 10 + 11 * i] = 0.75 + 0.05 * i
    components = find_components(foreground, ComponentParams(max_objects=3))
    np.testing.assert_array_equal(components.labels[0, 8, [6, 17, 28, 39, 50]], [0, 0, 3, 2, 1])


@pytest.mark.parametrize("level", [0.0, 0.5])
def test_a_map_below_a_half_has_no_objects(level):
    components = find_components(empty(level), PARAMS)
    assert components.labels.shape == (FRAMES, HEIGHT, WIDTH) and not components.labels.any()
    assert components.scores.shape == (0,)


def test_half_precision_gives_the_same_objects():
    foreground = np.random.default_rng(0).random((3, 20, 30), np.float32).astype(np.float16)
    half, single = find_components(foreground, PARAMS), find_components(foreground.astype(np.float32), PARAMS)
    np.testing.assert_array_equal(half.labels, single.labels)
    np.testing.assert_array_equal(half.scores, single.scores)


def test_labels_that_are_given_are_scored_as_those_that_are_found():
    foreground = empty()
    foreground[:, 5:13, 5:13], foreground[:, 20:34, 30:54] = 0.8, 0.95
    found = find_components(foreground, PARAMS)
    other = np.where(found.labels == 1, 9, np.where(found.labels == 2, 4, 0))
    kept = keep_best(foreground, other, PARAMS)
    np.testing.assert_array_equal(kept.labels, found.labels)
    np.testing.assert_array_equal(kept.scores, found.scores)


def test_an_object_is_boxed_only_where_it_is_present():
    masks = np.zeros((2, 6, 8), np.uint16)
    masks[1, 2:4, 3:8] = 2
    boxes = object_boxes(masks, 2)
    assert boxes.dtype == np.int32
    assert boxes.tolist() == [[[-1] * 4, [-1] * 4], [[-1] * 4, [3, 2, 8, 4]]]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(1, 14), st.integers(1, 14), st.floats(0.3, 1))
def test_any_map_gives_consistent_layouts(seed, num_frames, height, width, border_share):
    foreground = np.random.default_rng(seed).random((num_frames, height, width), np.float32) ** 2
    before = foreground.copy()
    components = find_components(foreground, ComponentParams(border_share=border_share, min_area=0))
    assert components.labels.dtype == np.uint16 and components.labels.shape == foreground.shape
    assert components.scores.dtype == np.float64 and (np.diff(components.scores) <= 0).all()
    assert set(np.unique(components.labels)) - {0} == set(range(1, len(components.scores) + 1))
    assert (foreground[components.labels > 0] > 0.5).all() and (components.scores > 0).all()
    assert np.array_equal(foreground, before)


def test_mirroring_the_frame_mirrors_the_objects():
    rng = np.random.default_rng(3)
    foreground = empty()
    for t in range(FRAMES):
        foreground[t, 8:18, 6 + t : 20 + t] = rng.uniform(0.7, 0.9)
        foreground[t, 22:36, 34:52] = rng.uniform(0.7, 0.9)
    plain = find_components(foreground, PARAMS)
    mirrored = find_components(foreground[:, :, ::-1], PARAMS)
    np.testing.assert_array_equal(mirrored.labels, plain.labels[:, :, ::-1])
    np.testing.assert_allclose(mirrored.scores, plain.scores)


def test_a_small_sure_object_is_kept_beside_a_large_one_and_a_brief_or_unsure_one_is_not():
    def beside(level: float, frames: int) -> int:
        foreground = np.full((16, HEIGHT, WIDTH), 0.1, np.float32)
        foreground[:, 5:35, 5:35] = 0.95
        foreground[:frames, 10:14, 50:54] = level
        return count(foreground)

    assert beside(0.9, 16) == beside(0.9, 12) == 2
    assert beside(0.9, 5) == beside(0.6, 16) == 1


def _with_part(probability=0.9, columns=slice(30, 40), **params):
    """An object with a piece that may be one of its own: the foreground, what was kept, and what is with the part."""
    foreground, part = empty(0.0), np.zeros((FRAMES, HEIGHT, WIDTH), int)
    foreground[:, 10:20, 5:20] = 0.9
    foreground[:, 10:20, columns] = probability
    part[:, 10:20, columns] = 7
    kept = Components((foreground > 0.5).astype(np.uint16), np.array([1.0]))
    return foreground, kept, keep_parts(foreground, kept, part, ComponentParams(**params))


def test_a_part_that_would_be_kept_alone_is_an_object():
    _, kept, parted = _with_part()
    assert parted.labels.dtype == np.uint16
    assert parted.scores[0] > parted.scores[1] > 0
    np.testing.assert_array_equal(parted.labels > 0, kept.labels > 0)
    np.testing.assert_array_equal(np.unique(parted.labels[:, 10:20, 30:40]), [2])
    np.testing.assert_array_equal(np.unique(parted.labels[:, 10:20, 5:20]), [1])


def test_the_better_part_is_the_first_object():
    parted = _with_part(columns=slice(30, 55))[2]
    np.testing.assert_array_equal(np.unique(parted.labels[:, 10:20, 30:55]), [1])


@pytest.mark.parametrize(
    "changes",
    [
        {"probability": 0.6, "columns": slice(30, 31)},
        {"columns": slice(WIDTH - 1, WIDTH)},
        {"max_objects": 1},
    ],
)
def test_other_parts_stay_in_their_object(changes):
    _, kept, parted = _with_part(**changes)
    np.testing.assert_array_equal(parted.labels, kept.labels)
    assert len(parted.scores) == 1


def test_parts_of_what_was_not_kept_are_none():
    foreground, kept = empty(), Components(np.zeros((FRAMES, HEIGHT, WIDTH), np.uint16), np.zeros(0))
    assert keep_parts(foreground, kept, np.ones(kept.labels.shape, int), PARAMS) is kept
