"""Evidence of the foreground for masks, and the estimates that are made of it."""

import numpy as np
import pytest

from moseg.schemas.parameters import ConfidenceParams
from moseg.tasks.confidence import MaskEvidence, estimate_confidence, kept_area, mask_evidence

PARAMS = ConfidenceParams(prior=0)
SHAPE = (60, 80)


def scene():
    """Return labels with an object of 20 x 20 px, and a probability to move of 0.9 in it."""
    labels, foreground = np.zeros(SHAPE, np.uint16), np.zeros(SHAPE, np.float32)
    labels[20:40, 30:50] = 1
    foreground[labels == 1] = 0.9
    return labels, foreground


def test_a_mask_that_holds_all_that_moves_encloses_everything():
    evidence = mask_evidence(*scene(), 2, PARAMS)
    np.testing.assert_allclose(evidence.inside, [np.nan, 0.9], rtol=1e-6)
    np.testing.assert_allclose(evidence.enclosed, [np.nan, 1.0])


def test_a_part_that_moves_beside_the_mask_is_missing_unless_it_is_far():
    labels, foreground = scene()
    near, far = foreground.copy(), foreground.copy()
    near[20:40, 50:55] = 0.9
    far[20:40, 70:75] = 0.9
    assert mask_evidence(labels, near, 2, PARAMS).enclosed[1] == pytest.approx(20 / 25, rel=1e-3)
    assert mask_evidence(labels, far, 2, PARAMS).enclosed[1] == 1


def test_another_object_beside_the_mask_is_not_a_part_of_it():
    labels, foreground = scene()
    labels[20:40, 50:55], foreground[20:40, 50:55] = 2, 0.9
    assert mask_evidence(labels, foreground, 4, PARAMS).enclosed[1] == 1
    assert np.isnan(mask_evidence(labels, foreground, 4, PARAMS).inside[3])


def inside(where, mask=np.s_[20:40, 30:50], around=0.9, low=0.1):
    """Return the evidence inside an object of whose pixels some have a low probability."""
    labels, foreground = np.zeros(SHAPE, np.uint16), np.zeros(SHAPE, np.float32)
    labels[mask], foreground[mask] = 1, around
    foreground[where] = low
    return mask_evidence(labels, foreground, 2, PARAMS).inside[1]


def test_what_moving_parts_surround_is_no_evidence_against_the_mask():
    """A plain part of an object does not show that it moves."""
    assert inside(np.s_[25:35, 35:45]) == pytest.approx(0.9)
    # Two parts, one of which is in the box around the other.
    parts = np.zeros(SHAPE, bool)
    parts[22:24, 34:46] = parts[22:34, 34:36] = parts[28:38, 44:46] = parts[36:38, 32:46] = True
    assert inside(parts) == pytest.approx(0.9)
    # Half of the mask, at its outline.
    assert inside(np.s_[30:40, 30:50]) == pytest.approx(0.5)
    assert inside(np.s_[25:35, 35:45], around=0.45) == pytest.approx(0.45 - 0.35 / 4)
    assert inside(np.s_[25:35, 35:45], around=0.55) == pytest.approx(0.55)


def test_a_part_that_does_not_move_at_all_is_evidence():
    assert inside(np.s_[25:35, 35:45], low=0.05) == pytest.approx(0.9 - 0.85 / 4)
    assert inside(np.s_[25:35, 35:45], low=0.07) == pytest.approx(0.9)


def test_a_thin_outline_does_not_speak_for_a_mask():
    assert inside(np.s_[21:39, 31:49]) == pytest.approx(0.9 - 0.8 * 324 / 400)


def test_a_part_at_one_side_of_the_frame_is_surrounded_if_little_of_it_is_open():
    bottom = np.s_[40:60, 30:50]
    assert inside(np.s_[45:60, 35:45], bottom) == pytest.approx(0.9)
    # 18 of 18 + 2 * 5 + 18 px are open.
    assert inside(np.s_[55:60, 31:49], bottom) == pytest.approx(0.9 - 0.8 * 90 / 400)


def test_another_object_surrounds_no_part_of_a_mask():
    """The part is at the outline of the mask, and the other object beside it."""
    labels, foreground = np.zeros(SHAPE, np.uint16), np.full(SHAPE, 0.9, np.float32)
    labels[10:50, 10:70] = 2
    labels[20:40, 30:50] = 1
    foreground[25:35, 30:40] = 0.1
    assert mask_evidence(labels, foreground, 3, PARAMS).inside[1] == pytest.approx(0.9 - 0.8 / 4)


@pytest.mark.parametrize("corner", [np.s_[:5, :5], np.s_[-5:, -5:]])
def test_an_object_at_the_frames_corner_is_measured_too(corner):
    labels, foreground = np.zeros(SHAPE, np.uint16), np.full(SHAPE, 0.5, np.float32)
    labels[corner] = 1
    evidence = mask_evidence(labels, foreground, 2, PARAMS)
    assert evidence.inside[1] == 0.5 and 0.3 < evidence.enclosed[1] < 0.9


def test_estimates_grow_with_the_evidence_and_are_open_without():
    shares = np.array([np.nan, 0.0, 0.5, 0.9, 1.0])
    confidence = estimate_confidence(MaskEvidence(shares, shares), PARAMS)
    for values in confidence:
        assert np.isnan(values[0]) and (np.diff(values[1:]) > 0).all()
        assert values[1] < 0.05 and values[4] > 0.99


def test_without_a_curve_the_evidence_is_the_estimate():
    plain = ConfidenceParams(sure_offset=0, sure_slope=1, complete_offset=0, complete_slope=1)
    shares = np.array([0.1, 0.5, 0.9])
    np.testing.assert_allclose(estimate_confidence(MaskEvidence(shares, shares), plain), [shares, shares])


def test_an_area_that_halves_is_half_kept_and_one_frame_does_not_count():
    areas = np.r_[np.full(20, 100), np.full(20, 50)]
    kept = kept_area(areas)
    np.testing.assert_array_equal(kept[:20], 1)
    np.testing.assert_array_equal(kept[20:], 0.5)
    areas = np.full(40, 100)
    areas[10] = 300
    np.testing.assert_array_equal(kept_area(areas), 1)


def test_a_slow_loss_over_seconds_is_kept():
    areas = np.linspace(100, 10, 400)
    assert kept_area(areas)[:300].min() > 0.8


def test_what_goes_away_keeps_its_area():
    """It halves in 10 frames, as its flow says."""
    growth = np.r_[np.zeros(20), np.full(10, np.log(0.5) / 10), np.zeros(20)]
    areas = 100 * np.exp(np.cumsum(growth))
    assert kept_area(areas)[35] == pytest.approx(0.5)
    np.testing.assert_allclose(kept_area(areas, growth), 1, atol=0.05)
    half = np.where(np.arange(50) < 35, areas, areas / 2)
    np.testing.assert_allclose(kept_area(half, growth)[40:], 0.5)


def test_what_comes_nearer_loses_nothing_by_that():
    np.testing.assert_array_equal(kept_area(np.full(50, 100), np.full(50, 0.05)), 1)


def test_a_large_area_counts_as_it_would_appear_now():
    """In the frames before, the largest area is not the one that would be largest now."""
    growth = np.where(np.arange(40) == 10, np.log(0.25), 0.0)
    areas = np.where(np.arange(40) < 10, 100.0, 60)
    assert kept_area(areas, growth)[25] == 1
    areas[20:] = 30
    assert kept_area(areas, growth)[25] == pytest.approx(0.5)
