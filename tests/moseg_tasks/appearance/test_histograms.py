import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.tasks.appearance import count_colours, count_sides

PARAMS = AppearanceParams(texture_levels=1, levels=4)
FOREGROUND = ForegroundParams()
SIZE = PARAMS.levels**3
SHAPE = (6, 8)
OBJECT, BACKGROUND, WATER = 5, 40, 63


def count(bins, strict, reliability=1.0, misfit=0.0, params=PARAMS):
    maps = [np.broadcast_to(np.float32(each), bins.shape) for each in (strict, reliability, misfit)]
    return count_colours(bins, *maps, params, FOREGROUND)


def scene() -> tuple[np.ndarray, np.ndarray]:
    """Colours and strict saliency of a frame whose left half moves."""
    bins = np.full(SHAPE, BACKGROUND, np.uint16)
    strict = np.zeros(SHAPE, np.float32)
    bins[:, :4], strict[:, :4] = OBJECT, 0.99
    return bins, strict


def random_frame(seed: int, shape=SHAPE):
    rng = np.random.default_rng(seed)
    maps = rng.random((3, *shape), np.float32)
    return rng.integers(0, SIZE, shape).astype(np.uint16), maps[0], maps[1], 5 * maps[2]


def test_moving_and_static_pixels_count_for_their_histograms():
    found = count(*scene())
    assert found.moving.shape == found.static.shape == (SIZE,)
    assert found.moving[OBJECT] == pytest.approx(24, rel=0.05) and found.moving[BACKGROUND] < 1e-6
    assert found.static[BACKGROUND] == pytest.approx(24, rel=0.05) and found.static[OBJECT] < 1e-3
    assert np.count_nonzero(found.moving) <= 2


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 5))
def test_counts_of_the_parts_of_a_frame_add_up_to_those_of_the_whole(seed, cut):
    frame = random_frame(seed)
    whole = count_colours(*frame, PARAMS, FOREGROUND)
    parts = [
        count_colours(*(each[rows] for each in frame), PARAMS, FOREGROUND) for rows in np.split(np.arange(6), [cut])
    ]
    for name in ("moving", "static", "reliability", "weight"):
        total = sum(getattr(part, name) for part in parts)
        np.testing.assert_allclose(total, getattr(whole, name), rtol=1e-5, atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000))
def test_no_pixel_counts_more_than_once_on_a_side(seed):
    found = count_colours(*random_frame(seed), PARAMS, FOREGROUND)
    assert found.moving.min() >= 0 and found.static.min() >= 0
    assert found.moving.sum() <= 48 and found.static.sum() <= 48
    assert 0 <= found.reliability <= found.weight + 1e-5


@given(st.integers(0, 1000))
def test_positions_of_pixels_do_not_matter(seed):
    frame = random_frame(seed)
    order = np.random.default_rng(seed).permutation(48)
    shuffled = [each.ravel()[order].reshape(SHAPE) for each in frame]
    here, there = (count_colours(*each, PARAMS, FOREGROUND) for each in (frame, shuffled))
    for name in here._fields:
        np.testing.assert_allclose(getattr(there, name), getattr(here, name), rtol=1e-4, atol=1e-7)


def test_inconsistent_motion_has_little_weight_and_counts_as_background():
    bins, strict = np.full(SHAPE, WATER, np.uint16), 0.99
    steady, torn = count(bins, strict, reliability=1.0), count(bins, strict, reliability=0.1)
    assert torn.moving[WATER] == pytest.approx(0.01 * steady.moving[WATER], rel=1e-3)
    assert torn.static[WATER] == pytest.approx(48 * PARAMS.unreliable_static * 0.9, rel=1e-3)
    assert steady.static[WATER] < 0.1


def test_pixels_that_do_not_move_with_the_object_have_little_weight():
    bins, strict = np.full(SHAPE, WATER, np.uint16), 0.9
    own, other = count(bins, strict, misfit=0.0), count(bins, strict, misfit=5.0)
    assert other.moving[WATER] < 0.05 * own.moving[WATER] and other.static[WATER] > 10 * own.static[WATER]
    deaf = PARAMS.model_copy(update={"misfit_weight": 0.0})
    assert count(bins, strict, misfit=5.0, params=deaf).moving[WATER] == own.moving[WATER]


def test_the_usual_reliability_is_that_of_what_is_salient_only():
    bins, strict = scene()
    reliability = np.where(strict > 0.5, 0.7, 0.1)
    found = count(bins, strict, reliability)
    assert found.reliability / found.weight == pytest.approx(0.7, rel=1e-3)
    assert found.weight == pytest.approx(24, rel=0.05)


@pytest.mark.parametrize("strict", [0.0, FOREGROUND.threshold - 0.01])
def test_frames_without_salient_pixels_do_not_count_for_the_usual_reliability(strict):
    found = count(np.zeros((1, 1), np.uint16), strict)
    assert found.reliability == found.weight == 0.0 and found.moving.sum() < 0.05 < found.static.sum()


TEXTURED = AppearanceParams(texture_levels=4, levels=2)
RED, GREEN = 5, 2  # of the eight colours
SMOOTH, ROUGH = 0, 3  # textures


def count_pixels(*pixels) -> dict[str, np.ndarray]:
    """Count pixels of one frame, each (colour, texture, moves, static); return both counts of textures by colour."""
    colours, textures, moving, static = np.array(pixels).T
    bins = (colours * TEXTURED.texture_levels + textures).astype(np.uint16)
    found = count_sides(bins, moving, static, TEXTURED)
    return {
        side: getattr(found, f"{side}_textures").reshape(-1, TEXTURED.texture_levels) for side in ("moving", "static")
    }


def test_textures_count_of_colours_that_move_and_rest_in_one_frame():
    found = count_pixels((RED, ROUGH, 6, 0), (RED, SMOOTH, 0, 3), (GREEN, SMOOTH, 5, 0))
    np.testing.assert_allclose(found["moving"][RED], [0, 0, 0, 2])
    np.testing.assert_allclose(found["static"][RED], [2, 0, 0, 0])
    assert not found["moving"][GREEN].any() and not found["static"][GREEN].any()


def test_a_thing_that_changes_its_texture_between_frames_is_not_compared_with_itself():
    far, near = count_pixels((RED, ROUGH, 6, 0)), count_pixels((RED, SMOOTH, 0, 6))
    assert not any(side.any() for side in (*far.values(), *near.values()))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000))
def test_a_colour_has_the_same_weight_on_both_sides_of_the_counts_of_textures(seed):
    rng = np.random.default_rng(seed)
    pixels = np.stack([rng.integers(0, 8, 30), rng.integers(0, 4, 30), *rng.exponential(size=(2, 30))], axis=1)
    pixels[:, 2:] *= rng.random((30, 2)) > 0.4
    found = count_pixels(*pixels)
    moving, static = (np.bincount(pixels[:, 0].astype(int), pixels[:, side], 8) for side in (2, 3))
    expected = moving * static / np.maximum(moving + static, 1e-9)
    for side, column in (("moving", 2), ("static", 3)):
        np.testing.assert_allclose(found[side].sum(axis=1), expected, atol=1e-9)
        texture = pixels[:, 0] * TEXTURED.texture_levels + pixels[:, 1]
        counts = np.bincount(texture.astype(int), pixels[:, column], 32).reshape(8, 4)
        shares = counts * expected[:, None] / np.maximum(counts.sum(axis=1, keepdims=True), 1e-9)
        np.testing.assert_allclose(found[side], shares, atol=1e-9)
