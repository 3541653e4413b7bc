"""Holes of plain colour belong to the object around them; what is seen through an object does not."""

import numpy as np
import pytest

from moseg.schemas.parameters import ComponentParams
from moseg.tasks.proposals import fill_holes

FRAMES, HEIGHT, WIDTH = 3, 40, 60
SPEED = 3
OBJECT, HOLE = np.s_[10:30, 15:45], np.s_[16:24, 25:37]
PLAIN = (90, 120, 60)
UNDECIDED, CLEAR = 0.4, 0.9


@pytest.fixture
def scene():
    """Return a textured object that moves to the right by `SPEED` px a frame, with a plain hole; nothing else moves."""
    rng = np.random.default_rng(0)
    images = np.repeat(rng.integers(0, 256, (1, HEIGHT, WIDTH, 3)).astype(np.uint8), FRAMES, axis=0)
    texture = rng.integers(0, 256, (20, 30, 3)).astype(np.uint8)
    labels, foreground = (
        np.zeros((FRAMES, HEIGHT, WIDTH), np.uint16),
        np.full((FRAMES, HEIGHT, WIDTH), 0.05, np.float16),
    )
    flows = np.zeros((FRAMES, 2, HEIGHT, WIDTH, 2), np.float32)
    for t in range(FRAMES):
        of_object, hole = _at(OBJECT, t), _at(HOLE, t)
        images[(t, *of_object)] = texture
        # The colours around the hole, too, are what is there in the neighbouring frames.
        images[(t, *_at(np.s_[12:28, 19:43], t))] = PLAIN
        labels[(t, *of_object)], labels[(t, *hole)] = 1, 0
        foreground[(t, *of_object)], foreground[(t, *hole)] = CLEAR, UNDECIDED
        flows[(t, slice(None), *of_object)] = np.array([-SPEED, SPEED])[:, None, None, None] * (1, 0)
    return {
        "labels": labels,
        "foreground": foreground,
        "images": images,
        "flows": flows,
        "residual_flows": flows.copy(),
    }


def _at(box, t):
    rows, columns = box
    return rows, slice(columns.start + SPEED * (t - 1), columns.stop + SPEED * (t - 1))


def _fill(scene, **params):
    return fill_holes(**scene, params=ComponentParams(**params))


def _filled_frames(scene, **params):
    """Return in which frames the hole belongs to the object."""
    found = _fill(scene, **params)
    inside = [found[(t, *_at(HOLE, t))] for t in range(FRAMES)]
    assert all(np.ptp(hole) == 0 for hole in inside)
    return [bool(hole.all()) for hole in inside]


def test_a_plain_hole_belongs_to_the_object_around_it(scene):
    before = {name: each.copy() for name, each in scene.items()}
    found = _fill(scene)
    for t in range(FRAMES):
        assert (found[(t, *_at(OBJECT, t))] == 1).all()
    assert found.dtype == np.uint16 and (found > 0).sum() == FRAMES * 20 * 30
    assert all(np.array_equal(before[name], each) for name, each in scene.items())


@pytest.mark.parametrize(("probability", "is_filled"), [(0.05, False), (0.06, False), (0.065, True), (0.45, True)])
def test_a_hole_of_low_probability_shows_the_background(scene, probability, is_filled):
    """The colour of this hole is even, so that a quarter of 0.25 suffices."""
    for t in range(FRAMES):
        scene["foreground"][(t, *_at(HOLE, t))] = probability
    assert _filled_frames(scene) == [is_filled] * FRAMES


@pytest.mark.parametrize("grey_levels", [2, 8])
def test_the_plainer_a_hole_the_lower_a_probability_suffices(scene, grey_levels):
    """Two neighbouring frames are brighter and darker than the one between, which no motion explains."""
    for t in range(FRAMES):
        scene["images"][(t, *_at(np.s_[12:28, 19:43], t))] = np.array(PLAIN) + grey_levels * (t - 1)
    needed = 0.25 * (0.25 + 0.75 * grey_levels / 10)
    for probability, is_filled in ((needed - 0.01, False), (needed + 0.01, True)):
        for t in range(FRAMES):
            scene["foreground"][(t, *_at(HOLE, t))] = probability
        assert _filled_frames(scene) == [is_filled] * FRAMES
    assert _filled_frames(scene, hole_even_share=1) == [needed + 0.01 >= 0.25] * FRAMES


def test_an_error_of_none_fills_only_what_is_exactly_even(scene):
    assert _filled_frames(scene, hole_error=0) == [True] * FRAMES
    scene["images"][1] += 1
    assert _filled_frames(scene, hole_error=0) == [False] * FRAMES


def test_the_mean_probability_of_a_hole_counts(scene):
    for t in range(FRAMES):
        rows, columns = _at(HOLE, t)
        scene["foreground"][t, rows, columns.start : columns.start + 6] = 0.05
    assert _filled_frames(scene, hole_even_share=1) == [False] * FRAMES
    assert _filled_frames(scene, hole_even_share=1, hole_probability=0.2) == [True] * FRAMES


@pytest.mark.parametrize(("low", "is_filled"), [((1,), True), ((0, 2), False)])
def test_a_hole_is_one_over_the_frames_that_share_its_pixels(scene, low, is_filled):
    for t in low:
        scene["foreground"][(t, *_at(HOLE, t))] = 0.01
    assert _filled_frames(scene) == [is_filled] * FRAMES


def test_holes_that_share_no_pixel_are_decided_apart(scene):
    far = {name: each.copy() for name, each in scene.items()}
    for name in ("labels", "foreground", "images"):
        # The hole is 8 px high, and 10 px lower in each frame.
        far[name][0], far[name][2] = np.roll(scene[name][0], -10, axis=0), np.roll(scene[name][2], 10, axis=0)
    far["flows"][:] = 0
    far["foreground"][1][_at(HOLE, 1)] = 0.01
    found = _fill(far, hole_error=255)
    filled = [bool((found[t] > 0).sum() == 20 * 30) for t in range(FRAMES)]
    assert filled == [True, False, True]


def test_a_hole_whose_colours_would_show_its_motion_is_left(scene):
    rng = np.random.default_rng(1)
    for t in range(FRAMES):
        scene["images"][(t, *_at(HOLE, t))] = rng.integers(0, 256, (8, 12, 3))
    assert _filled_frames(scene) == [False] * FRAMES
    assert _filled_frames(scene, hole_error=255) == [True] * FRAMES


def test_a_speck_in_a_plain_hole_does_not_matter(scene):
    for t in range(FRAMES):
        rows, columns = _at(HOLE, t)
        scene["images"][t, rows.start + 2, columns.start + 2] = 255
    assert _filled_frames(scene) == [True] * FRAMES


@pytest.mark.parametrize("other", [0, 2])
def test_one_neighbour_that_the_background_explains_suffices(scene, other):
    """In the other one something else may be in front."""
    scene["images"][other] = np.random.default_rng(2).integers(0, 256, (HEIGHT, WIDTH, 3))
    assert _filled_frames(scene)[1]
    scene["images"][2 - other] = scene["images"][other]
    assert not _filled_frames(scene)[1]


def test_the_motion_of_the_background_is_followed(scene):
    """The whole scene shifts by more than the hole is wide, to the right, as the background does."""
    shift = 14
    scene["images"][2] = np.roll(scene["images"][1], shift, axis=1)
    scene["images"][0] = np.roll(scene["images"][1], -shift, axis=1)
    assert not _filled_frames(scene)[1]
    scene["flows"] += np.array([-shift, shift])[:, None, None, None] * (1, 0)
    assert _filled_frames(scene)[1]


def test_without_a_neighbour_nothing_is_known_and_nothing_filled(scene):
    alone = {name: each[1:2] for name, each in scene.items()}
    assert np.array_equal(_fill(alone), alone["labels"])


def test_no_hole_is_filled_above_the_largest_probability(scene):
    assert np.array_equal(_fill(scene, hole_probability=1), scene["labels"])


def test_what_is_open_to_the_outside_is_no_hole(scene):
    opened = {**scene, "labels": scene["labels"].copy()}
    rows, columns = _at(HOLE, 1)
    opened["labels"][1, rows.start, columns.stop :] = 0
    assert _filled_frames(opened) == [True, False, True]


@pytest.fixture(params=[(0, -1), (0, 1), (1, -1), (1, 1)], ids=["top", "bottom", "left", "right"])
def at_the_border(request):
    """Return a plain scene and an object at one side of the frame, around a hole 20 px long that opens there by 8."""
    axis, end = request.param
    labels = np.zeros((HEIGHT, HEIGHT), np.uint16)
    labels[-24:, 8:32] = 1
    labels[-20:, 16:24] = 0
    labels = np.flip(labels, axis=0) if end < 0 else labels
    labels = labels.T if axis == 1 else labels
    shape = (FRAMES, HEIGHT, HEIGHT)
    return {
        "labels": np.repeat(labels[None], FRAMES, axis=0),
        "foreground": np.full(shape, UNDECIDED, np.float16),
        "images": np.full((*shape, 3), PLAIN, np.uint8),
        "flows": np.zeros((FRAMES, 2, *shape[1:], 2), np.float32),
        "residual_flows": np.zeros((FRAMES, 2, *shape[1:], 2), np.float32),
    }


def test_a_hole_may_be_open_to_a_side_of_the_frame(at_the_border):
    """8 px of its outline of 56 are there."""
    found = _fill(at_the_border)
    assert (found > 0).sum() == FRAMES * 24 * 24
    assert np.array_equal(_fill(at_the_border, hole_border=0.15), found)
    assert np.array_equal(_fill(at_the_border, hole_border=0.14), at_the_border["labels"])
    assert np.array_equal(_fill(at_the_border, hole_border=0), at_the_border["labels"])


def test_what_is_open_to_two_sides_of_the_frame_is_no_hole(at_the_border):
    """The object cuts off a corner of the frame."""
    at_the_border["labels"][:] = 0
    corner = at_the_border["labels"][:, -20:, -20:]
    corner[:] = 1
    corner[:, 4:, 4:] = 0
    assert np.array_equal(_fill(at_the_border, hole_border=1), at_the_border["labels"])


def test_a_hole_that_meets_the_outside_at_a_corner_is_closed(scene):
    labels = scene["labels"]
    labels[:] = 0
    labels[:, 10:30, 15:45] = 1
    whole = labels.copy()
    labels[:, 10, 15:30] = labels[:, 11:20, 30:40] = 0
    whole[:, 10, 15:30] = 0
    scene["images"][:], scene["foreground"][:] = 100, UNDECIDED
    assert np.array_equal(_fill(scene), whole)


def test_a_hole_between_two_objects_belongs_to_neither(scene):
    for t in range(FRAMES):
        rows, columns = _at(OBJECT, t)
        right = scene["labels"][t, rows, columns.start + 16 : columns.stop]
        right[right > 0] = 2
    assert np.array_equal(_fill(scene), scene["labels"])


def test_each_object_has_its_own_holes(scene):
    labels = np.zeros((FRAMES, HEIGHT, WIDTH), np.uint16)
    labels[:, 2:12, 2:20], labels[:, 20:38, 30:58] = 3, 7
    whole = labels.copy()
    labels[:, 5:8, 6:12] = labels[:, 24:30, 35:45] = labels[:, 33:35, 50:54] = 0
    scene |= {"labels": labels, "images": np.full_like(scene["images"], 100)}
    scene["foreground"][:] = UNDECIDED
    assert np.array_equal(_fill(scene), whole)


def test_an_object_inside_a_hole_stays(scene):
    labels = scene["labels"]
    labels[:] = 0
    labels[:, 5:35, 5:55], labels[:, 10:30, 10:50], labels[:, 15:25, 20:40] = 1, 0, 2
    scene["images"][:], scene["foreground"][:] = 100, UNDECIDED
    assert np.array_equal(_fill(scene), labels)
