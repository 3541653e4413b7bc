import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_tasks.proposals import object_boxes, propose_objects
from schemas.parameters import ProposalParams

PARAMS = ProposalParams()
FRAMES, HEIGHT, WIDTH = 6, 40, 60


def empty(level: float = 0.1) -> np.ndarray:
    return np.full((FRAMES, HEIGHT, WIDTH), level, np.float32)


def test_two_movers_are_two_objects_followed_through_time_best_first():
    accumulated = empty()
    for t in range(FRAMES):
        accumulated[t, 5:13, 5 + t : 13 + t] = 0.8
        accumulated[t, 20:34, 40 - t : 54 - t] = 0.95
    proposals = propose_objects(accumulated, (HEIGHT, WIDTH), PARAMS)
    assert len(proposals.scores) == 2 and proposals.scores[0] > proposals.scores[1]
    for t in range(FRAMES):
        assert (proposals.masks[t, 22:32, 42 - t : 52 - t] == 1).all()
        assert (proposals.masks[t, 7:11, 7 + t : 11 + t] == 2).all()
        assert tuple(proposals.boxes[1, t]) == (5 + t, 5, 13 + t, 13)


def test_objects_that_touch_at_one_time_are_one():
    accumulated = empty()
    for t in range(FRAMES):
        accumulated[t, 10:20, 5 + 3 * t : 15 + 3 * t] = 0.9
        accumulated[t, 10:20, 45 - 3 * t : 55 - 3 * t] = 0.9
    assert len(propose_objects(accumulated, (HEIGHT, WIDTH), PARAMS).scores) == 1


def test_the_score_is_the_soft_mass_of_a_component_inside_the_frame():
    accumulated = empty()
    accumulated[2:4, 10:20, 10:30] = 0.9
    odds = (0.9 / 0.1) / (0.6 / 0.4)
    probability = odds**1.5 / (1 + odds**1.5)
    scores = propose_objects(accumulated, (HEIGHT, WIDTH), PARAMS).scores
    np.testing.assert_allclose(scores, [2 * 10 * 20 * probability], rtol=1e-5)


def test_the_score_falls_with_the_share_of_the_outline_on_the_frame_s_border():
    inside, touching = empty(), empty()
    inside[:, 10:20, 10:30] = touching[:, :10, 10:30] = 0.9
    whole = propose_objects(inside, (HEIGHT, WIDTH), PARAMS).scores[0]
    lessened = propose_objects(touching, (HEIGHT, WIDTH), PARAMS).scores[0]
    outline = 2 * (10 + 20) - 4
    assert lessened / whole == pytest.approx(1 - 20 / outline / PARAMS.border_share)


def test_a_strip_along_the_border_is_no_object():
    accumulated = empty()
    accumulated[:, -6:, :] = 0.95
    assert len(propose_objects(accumulated, (HEIGHT, WIDTH), PARAMS).scores) == 0


def test_objects_far_below_the_best_and_specks_are_dropped():
    accumulated = empty()
    accumulated[:, 5:25, 5:35] = 0.9
    accumulated[:, 30:34, 45:49] = 0.9
    assert len(propose_objects(accumulated, (HEIGHT, WIDTH), PARAMS).scores) == 1
    kept = ProposalParams(score_ratio=0.01)
    assert len(propose_objects(accumulated, (HEIGHT, WIDTH), kept).scores) == 2
    large_only = ProposalParams(score_ratio=0.01, min_area=0.01)
    assert len(propose_objects(accumulated, (HEIGHT, WIDTH), large_only).scores) == 1


def test_only_the_best_objects_are_kept_when_there_are_many():
    accumulated = empty()
    for i in range(5):
        accumulated[:, 4:12, 2 + 11 * i : 10 + 11 * i] = 0.95 - 0.05 * i
    proposals = propose_objects(accumulated, (HEIGHT, WIDTH), ProposalParams(max_objects=3))
    assert set(np.unique(proposals.masks)) == {0, 1, 2, 3}
    assert (proposals.masks[0, 8, [6, 17, 28, 39, 50]] == [1, 2, 3, 0, 0]).all()


@pytest.mark.parametrize("level", [0.0, 0.6])
def test_nothing_above_the_threshold_is_no_object(level):
    proposals = propose_objects(empty(level), (80, 120), PARAMS)
    assert proposals.masks.shape == (FRAMES, 80, 120) and not proposals.masks.any()
    assert proposals.scores.shape == (0,) and proposals.boxes.shape == (0, FRAMES, 4)


def test_an_object_enlarged_lies_where_it_was():
    accumulated = empty(0.0)
    accumulated[:, 10:20, 10:30] = 1.0
    proposals = propose_objects(accumulated, (HEIGHT * 3, WIDTH * 3), PARAMS)
    expected = np.zeros((HEIGHT * 3, WIDTH * 3), bool)
    expected[30:60, 30:90] = True
    mask = proposals.masks[0] > 0
    assert (mask & expected).sum() / (mask | expected).sum() > 0.95
    assert np.abs(proposals.boxes[0, 0] - [30, 30, 90, 60]).max() <= 1


def test_an_object_is_boxed_only_where_it_is_present():
    masks = np.zeros((2, 6, 8), np.uint16)
    masks[1, 2:4, 3:8] = 2
    boxes = object_boxes(masks, 2)
    assert boxes.dtype == np.int32
    assert boxes.tolist() == [[[-1] * 4, [-1] * 4], [[-1] * 4, [3, 2, 8, 4]]]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 12), st.integers(1, 12), st.integers(1, 30), st.integers(1, 30))
def test_any_map_gives_consistent_layouts(seed, height, width, full_height, full_width):
    accumulated = np.random.default_rng(seed).random((3, height, width), np.float32)
    before = accumulated.copy()
    proposals = propose_objects(accumulated, (full_height, full_width), PARAMS)
    assert proposals.masks.dtype == np.uint16 and proposals.masks.shape == (3, full_height, full_width)
    assert proposals.scores.dtype == np.float64 and (np.diff(proposals.scores) <= 0).all()
    assert proposals.masks.max() <= len(proposals.scores) <= PARAMS.max_objects
    assert proposals.boxes.shape == (len(proposals.scores), 3, 4)
    assert np.array_equal(accumulated, before)


def test_mirroring_the_frame_mirrors_the_objects():
    rng = np.random.default_rng(3)
    accumulated = empty()
    for t in range(FRAMES):
        accumulated[t, 8:18, 6 + t : 20 + t] = rng.uniform(0.7, 0.9)
        accumulated[t, 22:36, 34:52] = rng.uniform(0.7, 0.9)
    plain = propose_objects(accumulated, (HEIGHT, WIDTH), PARAMS)
    mirrored = propose_objects(accumulated[:, :, ::-1], (HEIGHT, WIDTH), PARAMS)
    np.testing.assert_array_equal(mirrored.masks, plain.masks[:, :, ::-1])
    np.testing.assert_allclose(mirrored.scores, plain.scores)
