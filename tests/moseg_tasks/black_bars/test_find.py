"""Black bars are dark lines up to a straight edge of the picture; dark parts of the scene are none."""

import cv2
import numpy as np
import pytest

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.parameters import BlackBarParams
from moseg.tasks.black_bars import find_bars

HEIGHT, WIDTH = 60, 80
NONE = BlackBars(0, 0, 0, 0)


def _find(images, **params):
    return find_bars(images, BlackBarParams(**params))


def _frames(left=0, top=0, right=0, bottom=0, num_frames=3, low=40):
    images = np.random.default_rng(0).integers(low, 255, (num_frames, HEIGHT, WIDTH, 3)).astype(np.uint8)
    images[:, :top], images[:, HEIGHT - bottom :] = 0, 0
    images[:, :, :left], images[:, :, WIDTH - right :] = 0, 0
    return list(images)


def _night(num_frames=8):
    """Return frames of a town at night: a black sky down to roofs of different heights, with lit windows below."""
    heights = np.repeat(np.random.default_rng(1).integers(22, 40, 10), WIDTH // 10)
    town = np.arange(HEIGHT)[:, None] >= heights
    lit = np.random.default_rng(2).integers(40, 255, (HEIGHT, WIDTH, 3)) * town[..., None]
    return [lit.astype(np.uint8) for _ in range(num_frames)]


@pytest.mark.parametrize(
    "bars", [NONE, BlackBars(0, 9, 0, 7), BlackBars(20, 0, 21, 0), BlackBars(3, 4, 0, 5), BlackBars(20, 9, 21, 7)]
)
def test_bars_are_found_at_each_side(bars):
    assert _find(_frames(**bars._asdict())) == bars


def test_a_bar_is_dark_in_all_frames():
    fading = _frames(top=9, num_frames=16)
    fading[5][4, :20] = 200
    assert _find(fading).top == 0
    fading[5] = _frames()[0]
    assert _find(fading) == NONE
    assert _find(_frames(low=0)) == NONE


def test_what_coding_leaves_beside_the_picture_is_still_a_bar():
    frames = _frames(top=9)
    for image in frames:
        image[:9] = 3
        image[8, 5] = 90
    assert _find(frames).top == 9
    assert _find(frames, max_level=2) == NONE


def test_a_bar_is_found_although_most_frames_are_dark_or_black():
    dark = [image // 12 for image in _frames(top=9, num_frames=6)]
    black = [np.zeros((HEIGHT, WIDTH, 3), np.uint8)]
    assert _find([*black, *dark]) == NONE
    assert _find([*black, *dark, *_frames(top=9, num_frames=1)]).top == 9


def test_a_bar_is_found_where_reduced_frames_mix_its_edge_with_the_picture():
    reduced = [cv2.resize(image, (WIDTH, 25), interpolation=cv2.INTER_AREA) for image in _frames(top=9, low=30)]
    # 9 lines become 3.75.
    assert _find(reduced).top in (3, 4)


def test_a_black_sky_above_a_town_is_no_bar():
    assert _find(_night()) == NONE


def test_the_bars_of_a_night_scene_are_not_taken_for_more_than_they_are():
    """A bar beside a black sky cannot be told from it, and is left as it is; that at the other end is found."""
    night = _night()
    for image in night:
        image[:5] = 0
        image[HEIGHT - 5 :] = 0
    assert _find(night) == BlackBars(0, 0, 0, 5)


@pytest.mark.parametrize("step", [0, 9])
def test_a_black_room_around_what_moves_is_no_bar(step):
    """Above and beside a single object in the dark there is no straight edge, wherever it goes."""
    frames = []
    for number in range(8):
        image = np.zeros((240, 320, 3), np.uint8)
        cv2.circle(image, (100 + step * number, 120), 60, (200, 180, 160), -1)
        frames.append(image)
    assert _find(frames) == NONE


def test_frames_that_are_black_all_over_have_no_bars():
    assert _find([np.zeros((HEIGHT, WIDTH, 3), np.uint8)] * 2) == NONE


def test_a_line_at_the_edge_is_no_bar_in_large_frames():
    images = np.full((2, 400, 40, 3), 200, np.uint8)
    images[:, :3] = 0
    assert _find(list(images)) == NONE
    images[:, :4] = 0
    assert _find(list(images)).top == 4


def test_too_small_a_picture_has_no_bars():
    bars = BlackBars(left=30, right=30)
    assert _find(_frames(**bars._asdict())) == bars
    assert _find(_frames(**bars._asdict()), min_picture=0.3) == NONE
    assert _find(_frames(left=33, right=33, top=9)) == NONE
