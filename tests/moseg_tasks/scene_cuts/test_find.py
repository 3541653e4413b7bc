"""Cuts: what changes at once and is not seen in the frame before."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import SceneCutParams
from moseg.tasks.scene_cuts import find_cuts

PARAMS = SceneCutParams()


def _scene(seed, num_frames, speed=2, shape=(120, 214)):
    """Return frames of a camera that pans over a texture, `speed` px a frame."""
    rng = np.random.default_rng(seed)
    noise = rng.integers(0, 256, (shape[0], shape[1] + speed * num_frames, 3)).astype(np.uint8)
    texture = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 4), None, 0, 255, cv2.NORM_MINMAX)
    return [texture[:, speed * index : speed * index + shape[1]] for index in range(num_frames)]


@pytest.mark.parametrize("speed", [0, 2, 5])
def test_a_cut_is_found_where_the_scene_changes(speed):
    assert find_cuts([*_scene(0, 9, speed), *_scene(1, 7, speed), *_scene(2, 8, speed)], PARAMS) == [9, 16]


@pytest.mark.parametrize("speed", [0, 2, 9, 60])
def test_no_cut_is_found_in_one_scene_however_fast_the_camera_turns(speed):
    assert find_cuts(_scene(0, 16, speed), PARAMS) == []


@pytest.mark.parametrize("shape", [(2, 900), (900, 2), (48, 854), (20, 30)])
def test_frames_of_any_shape_are_searched(shape):
    assert set(find_cuts([*_scene(0, 8, shape=shape), *_scene(1, 8, shape=shape)], PARAMS)) <= {8}


def test_a_camera_that_starts_at_once_is_no_cut():
    scene = _scene(0, 16, 4)
    assert find_cuts([*[scene[0]] * 8, *scene], PARAMS) == []


# Found as a plain frame, and by the contrast of the pixels that flow leads to.
@pytest.mark.parametrize("params", [PARAMS, SceneCutParams(max_plain=0), SceneCutParams(max_contrast_ratio=1e6)])
@pytest.mark.parametrize("level", [0, 120, 255])
@pytest.mark.parametrize("has_text", [False, True])
def test_a_plain_card_is_another_scene(level, has_text, params):
    card = np.full((120, 214, 3), level, np.uint8)
    if has_text:
        cv2.putText(card, "THE END", (40, 70), cv2.FONT_HERSHEY_SIMPLEX, 1, (200, 60, 60), 2)
    assert find_cuts([*_scene(0, 9), *[card] * 6, *_scene(1, 7)], params) == [9, 15]


def test_scenes_that_fade_through_black_are_apart():
    light = [*np.ones(18), *np.linspace(1, 0, 12)]
    out = [(share * frame).astype(np.uint8) for share, frame in zip(light, _scene(0, 30), strict=True)]
    back = [(share * frame).astype(np.uint8) for share, frame in zip(light[::-1], _scene(1, 30), strict=True)]
    cuts = find_cuts([*out, *back], PARAMS)
    # The last frame of one and the first frame of the other are black, and those beside them nearly are.
    assert len(cuts) == 2 and 27 <= cuts[0] <= 29 and 31 <= cuts[1] <= 33


def test_a_scene_that_is_almost_plain_is_not_cut_again_and_again():
    rng = np.random.default_rng(0)
    levels = 2.2 * (1 + 0.15 * rng.standard_normal(40))
    texture = np.tile(np.array([[-1.0, 1.0], [1.0, -1.0]]).repeat(4, 0).repeat(4, 1), (15, 20))[..., None]
    frames = [np.clip(60 + level * texture, 0, 255).round().astype(np.uint8).repeat(3, axis=2) for level in levels]
    assert len(find_cuts(frames, PARAMS)) <= 1


def test_light_that_changes_at_once_is_no_cut():
    scene = _scene(0, 16)
    darker = [(0.4 * frame).astype(np.uint8) for frame in scene[8:]]
    assert find_cuts([*scene[:8], *darker], PARAMS) == []
    assert find_cuts([*darker, *scene[:8][::-1]], PARAMS) == []


def test_a_flash_of_light_is_no_cut():
    scene = _scene(0, 16)
    scene[8] = (0.2 * scene[8] + 200).astype(np.uint8)
    assert find_cuts(scene, PARAMS) == []


def test_no_cut_is_found_if_none_is_searched():
    assert find_cuts([*_scene(0, 9), *_scene(1, 7)], SceneCutParams(max_consistent=0)) == []


def test_the_first_and_last_frames_may_be_another_scene():
    assert find_cuts([*_scene(1, 1), *_scene(0, 9), *_scene(2, 1)], PARAMS) == [1, 10]
