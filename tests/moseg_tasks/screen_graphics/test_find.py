"""Graphics are edges that do not move at all in front of a scene that does; nothing else is one."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import ScreenGraphicsParams
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.tasks.screen_graphics import find_graphics, graphics_mask

HEIGHT, WIDTH, NUM_FRAMES = 180, 240, 17
NONE = ScreenGraphics()
FACE, WHITE = cv2.FONT_HERSHEY_SIMPLEX, (255, 255, 255)
PLAIN = np.s_[20:61, 150:207]
"""Box around the letters of `_badge`."""


def _find(frames, **params):
    return find_graphics(frames[:-1], frames[1:], ScreenGraphicsParams(**params))


def _scene(step=4, num_frames=NUM_FRAMES, scale=1):
    """Return frames of a smooth texture that moves to the left by `step` px a frame."""
    rng, width = np.random.default_rng(0), WIDTH * scale
    noise = rng.integers(0, 256, (HEIGHT * scale, width + step * num_frames, 3)).astype(np.uint8)
    smooth = cv2.GaussianBlur(noise, (0, 0), 2 * scale).astype(np.float32)
    wide = np.clip(120 + 60 * (smooth - smooth.mean()) / smooth.std(), 0, 255).astype(np.uint8)
    return [wide[:, step * index : step * index + width].copy() for index in range(num_frames)]


def _logo(frame, scale=1):
    corner, thickness = (150 * scale, 40 * scale), 2 * scale
    return cv2.putText(frame.copy(), "TV 5", corner, FACE, scale, WHITE, thickness, cv2.LINE_AA)


def _badge(frame, opacity=0.75):
    """Draw letters on a plain box, through which some of the scene shines."""
    rows, columns = PLAIN
    drawn = cv2.rectangle(
        frame.copy(), (columns.start, rows.start), (columns.stop - 1, rows.stop - 1), (200, 30, 30), -1
    )
    cv2.putText(drawn, "TV", (157, 52), FACE, 1.1, WHITE, 2, cv2.LINE_AA)
    return cv2.addWeighted(drawn, opacity, frame, 1 - opacity, 0)


def _clock(frame, second, is_on_plain_ground):
    drawn = frame.copy()
    if is_on_plain_ground:
        cv2.rectangle(drawn, (15, 142), (132, 166), (20, 20, 60), -1)
    for colour, thickness in (((0, 0, 0), 4), (WHITE, 2)):
        cv2.putText(drawn, f"26-11 16:33:{second:02}", (20, 160), FACE, 0.5, colour, thickness, cv2.LINE_AA)
    return drawn


def _caption(frame):
    """Draw lines of text that fill most of the frame."""
    drawn = frame.copy()
    for row in range(30, HEIGHT, 35):
        cv2.putText(drawn, "LONG TEXT", (2, row), FACE, 1.3, WHITE, 3, cv2.LINE_AA)
    return drawn


def _followed(frame, index, sway):
    """Draw a thing that the camera follows, and that sways in the frame by `sway` px."""
    thing = _logo(np.zeros_like(frame))
    move = np.float32([[1, 0, sway * np.sin(1.7 * index)], [0, 1, sway * np.cos(1.1 * index)]])
    layer = cv2.warpAffine(thing, move, (WIDTH, HEIGHT)).astype(np.float32)
    return (frame * (1 - layer / 255) + layer).astype(np.uint8)


def _drawn(frames, drawn):
    """Return where a frame at least was drawn into."""
    return np.any([np.any(before != after, axis=-1) for before, after in zip(frames, drawn, strict=True)], axis=0)


def _mask(found, shape=(HEIGHT, WIDTH)):
    return graphics_mask(found, shape)


@pytest.mark.parametrize("step", [1, 4])
def test_a_logo_is_covered_and_little_else(step):
    frames = _scene(step)
    logos = [_logo(frame) for frame in frames]
    mask, drawn = _mask(_find(logos)), _drawn(frames, logos)
    assert mask[drawn].mean() > 0.99
    surroundings = cv2.dilate(drawn.astype(np.uint8), np.ones((21, 21), np.uint8)) > 0
    assert mask.sum() < 3 * drawn.sum() and not mask[~surroundings].any()


@pytest.mark.parametrize("step", [0, 1, 4])
def test_a_scene_without_graphics_has_none(step):
    assert _find(_scene(step)) == NONE


def test_in_front_of_a_camera_that_stands_still_a_logo_cannot_be_told_from_the_scene():
    assert _find([_logo(frame) for frame in _scene(step=0)]) == NONE


def test_what_moves_in_half_of_the_frame_does_not_make_the_other_half_a_graphic():
    frames = _scene()
    for frame in frames:
        frame[:, : WIDTH // 2] = frames[0][:, : WIDTH // 2]
    assert _find(frames) == NONE and _find(frames, max_area=0.9, max_still=0.25) == NONE
    assert _find(frames, max_area=0.9, min_motion=0).parts


def test_what_stands_in_a_busy_place_before_a_camera_at_rest_is_no_graphic():
    """Of the few strong edges most move, each thing in its own way, but the place itself does not."""
    rng, texture = np.random.default_rng(2), _scene(0)[0]
    starts, steps = rng.uniform((0, 70), (WIDTH, HEIGHT), (8, 2)), rng.uniform(-5, 5, (8, 2))
    frames = []
    for index in range(NUM_FRAMES):
        frame = _logo((90 + 0.2 * texture).astype(np.uint8))
        for x, y in (starts + index * steps).astype(int) % (WIDTH, HEIGHT):
            window = frame[max(y, 66) : y + 24, x : x + 24]
            window[:] = texture[: window.shape[0], : window.shape[1]]
        frames.append(frame)
    assert _find(frames) == NONE
    assert _find(frames, min_motion=0).parts


@pytest.mark.parametrize(("period", "is_found"), [(1, True), (2, False)])
def test_the_less_often_the_background_seems_to_move_the_fewer_edges_may_stand_still(period, is_found):
    """A camera at rest sees a quarter of its scene beside something large, whose motion is taken for its own."""
    frames = [frame.copy() for frame in np.repeat(_scene(), period, axis=0)[:NUM_FRAMES]]
    for frame in frames:
        frame[:, : WIDTH // 4] = frames[0][:, : WIDTH // 4]
    assert bool(_find(frames).parts) == is_found
    assert _find(frames, max_still=1).parts


@pytest.mark.parametrize("num_frames", [2, 8, 9])
def test_fewer_than_nine_frames_say_too_little(num_frames):
    found = _find([_logo(frame) for frame in _scene(num_frames=num_frames)])
    assert bool(found.parts) == (num_frames == 9)


def test_the_plain_ground_beyond_the_letters_of_a_translucent_box_is_covered_too():
    mask = _mask(_find([_badge(frame) for frame in _scene()]))
    assert mask[PLAIN].mean() > 0.99 and mask.sum() < 1.25 * mask[PLAIN].size


def test_without_a_reach_only_what_is_beside_the_letters_is_covered():
    mask = _mask(_find([_badge(frame) for frame in _scene()], reach=0, steadiness=0))
    assert 0.2 < mask[PLAIN].mean() < 0.7


@pytest.mark.parametrize("sway", [0.5, 1, 2])
def test_what_the_camera_follows_sways_and_is_no_graphic(sway):
    frames = [_followed(frame, index, sway) for index, frame in enumerate(_scene())]
    assert _find(frames) == NONE


def test_a_sway_is_a_graphic_where_larger_shifts_are_allowed():
    """Half a pixel leaves edges in the median frame: it is the shift that tells them from a graphic's."""
    frames = [_followed(frame, index, 0.5) for index, frame in enumerate(_scene())]
    assert _find(frames, max_shift=1, min_agreement=0.6).parts


@pytest.mark.parametrize(("start", "end"), [((0, 90), (WIDTH, 90)), ((90, 0), (90, HEIGHT)), ((0, 0), (WIDTH, HEIGHT))])
def test_a_straight_line_across_the_frame_is_no_graphic(start, end):
    """Along a line no shift can be seen: it may be a rope, or the horizon."""
    frames = [cv2.line(frame, start, end, WHITE, 3) for frame in _scene()]
    assert _find(frames, max_still=1) == NONE


def test_places_are_those_in_frames_that_are_searched_at_a_smaller_size():
    frames = _scene(step=12, scale=3)
    logos = [_logo(frame, scale=3) for frame in frames]
    mask, drawn = _mask(_find(logos, side=WIDTH), frames[0].shape[:2]), _drawn(frames, logos)
    assert mask[drawn].mean() > 0.99 and mask.sum() < 3 * drawn.sum()


def test_of_more_than_the_largest_area_nothing_is_a_graphic():
    captions = [_caption(frame) for frame in _scene()]
    assert _find(captions, max_still=1) == NONE
    assert _mask(_find(captions, max_still=1, max_area=0.9)).mean() > 0.3


def test_a_logo_in_half_of_the_frames_is_none():
    frames = _scene()
    assert _find([_logo(frame) if index % 2 else frame for index, frame in enumerate(frames)]) == NONE
    assert _find([_logo(frame) if index else frame for index, frame in enumerate(frames)]).parts


@pytest.mark.parametrize(("is_on_plain_ground", "least"), [(True, 0.98), (False, 0.8)])
def test_of_a_clock_whose_last_digits_change_most_is_covered(is_on_plain_ground, least):
    """Without a ground, the digits that change with every frame have no edges that stand still."""
    frames = _scene()
    clocks = [_clock(frame, index, is_on_plain_ground) for index, frame in enumerate(frames)]
    mask, drawn = _mask(_find(clocks)), _drawn(frames, clocks)
    assert mask[drawn].mean() > least and mask.sum() < 2 * drawn.sum()


def test_a_logo_is_found_in_noise_and_although_it_grows_darker():
    rng, frames = np.random.default_rng(1), _scene()
    logos = [_logo(frame) * (1 - 0.01 * index) for index, frame in enumerate(frames)]
    noisy = [np.clip(logo + rng.normal(0, 3, logo.shape), 0, 255).astype(np.uint8) for logo in logos]
    assert _mask(_find(noisy))[_drawn(frames, [_logo(frame) for frame in frames])].mean() > 0.95


def test_frames_stay_as_they_are():
    frames = [_badge(frame) for frame in _scene()]
    before = [frame.copy() for frame in frames]
    _find(frames)
    assert np.array_equal(frames, before)
