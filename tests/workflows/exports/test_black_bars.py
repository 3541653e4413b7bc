"""Black bars around the picture: found in frames as they are decoded, and named with what to do about them."""

import numpy as np
import pytest

from moseg.workflows.exports.black_bars import BlackBars, describe_bars, find_bars, sampled

HEIGHT, WIDTH = 60, 80
NONE = BlackBars(0, 0, 0, 0)


def _frames(left=0, top=0, right=0, bottom=0, num_frames=3, low=40):
    images = np.random.default_rng(0).integers(low, 255, (num_frames, HEIGHT, WIDTH, 3)).astype(np.uint8)
    images[:, :top], images[:, HEIGHT - bottom :] = 0, 0
    images[:, :, :left], images[:, :, WIDTH - right :] = 0, 0
    return list(images)


@pytest.mark.parametrize("bars", [NONE, BlackBars(0, 9, 0, 7), BlackBars(20, 0, 21, 0), BlackBars(3, 4, 0, 5)])
def test_bars_are_found_at_each_side(bars):
    assert find_bars(_frames(**bars._asdict())) == bars


def test_a_bar_is_dark_in_all_frames():
    fading = _frames(top=9)
    fading[1] = _frames()[0]
    assert find_bars(fading) == NONE
    assert find_bars(_frames(low=0)) == NONE


def test_what_coding_leaves_beside_the_picture_is_still_a_bar():
    frames = _frames(top=9)
    for image in frames:
        image[:9] = 3
        image[8, 5] = 90
    assert find_bars(frames).top == 9


def test_frames_that_are_black_all_over_have_no_bars():
    assert find_bars([np.zeros((HEIGHT, WIDTH, 3), np.uint8)] * 2) == NONE


def test_a_line_at_the_edge_is_no_bar_in_large_frames():
    images = np.full((2, 400, 40, 3), 200, np.uint8)
    images[:, :3] = 0
    assert find_bars(list(images)) == NONE
    images[:, :4] = 0
    assert find_bars(list(images)).top == 4


def test_the_line_speaks_of_the_videos_own_pixels():
    (line,) = describe_bars(BlackBars(0, 9, 0, 7), (60, 80), (120, 160))
    assert "(18 px above, 14 px below)" in line and "crop=160:88:0:18 " in line
    (line,) = describe_bars(BlackBars(3, 0, 4, 0), (60, 80), (60, 80))
    # Encoders take even sizes: at most a pixel of the picture is lost.
    assert "(4 px left, 4 px right)" in line and "crop=72:60:4:0 " in line
    assert describe_bars(NONE, (60, 80), (120, 160)) == ()


@pytest.mark.parametrize("count", [1, 2, 8, 100])
def test_frames_are_sampled_from_the_first_to_the_last(count):
    indices = sampled(count)
    assert indices[0] == 0 and indices[-1] == count - 1
    assert len(indices) == min(count, 8)


def test_a_run_names_them(moseg, write_squares, tmp_path):
    from PIL import Image

    frames = sorted((write_squares(tmp_path / "clip", num_frames=4) / "frames").iterdir())
    for path in frames:
        image = np.asarray(Image.open(path).convert("RGB")).copy()
        image[:10] = 0
        Image.fromarray(image).save(path)
    ran = moseg("segment", frames[0].parent, "--out", tmp_path / "out", "--store", tmp_path / "store")
    assert ran.code == 0
    assert "look at: black bars (10 px above)" in ran.out + ran.err
