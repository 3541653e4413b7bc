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


def _set_probability(scene, probability, frames=range(FRAMES)):
    for t in frames:
        scene["foreground"][(t, *_at(HOLE, t))] = probability


def _set_pattern(scene, roughness):
    """Show in the hole and around it a pattern that stands still, whose colours 2 px apart differ by `roughness`."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    pattern = (np.array(PLAIN) + roughness * ((x // 2 + y // 2) % 2)[..., None]).astype(np.uint8)
    for t in range(FRAMES):
        around = _at(np.s_[12:28, 19:43], t)
        scene["images"][(t, *around)] = pattern[around]


@pytest.mark.parametrize(("probability", "is_filled"), [(0.05, False), (0.06, False), (0.065, True), (0.45, True)])
def test_a_hole_of_low_probability_shows_the_background(scene, probability, is_filled):
    """This hole has a single colour, so that a quarter of 0.25 suffices."""
    _set_probability(scene, probability)
    assert _filled_frames(scene) == [is_filled] * FRAMES


@pytest.mark.parametrize(("roughness", "needed"), [(1, 0.25 * 2.5 / 7), (4, 0.25 * 4.75 / 7), (7, 0.25), (20, 0.25)])
def test_the_plainer_a_hole_the_lower_a_probability_suffices(scene, roughness, needed):
    """Colours 2 px apart differ by `roughness` in each direction, and what is seen in the hole stands still."""
    _set_pattern(scene, roughness)
    for probability, is_filled in ((needed - 0.01, False), (needed + 0.01, True)):
        _set_probability(scene, probability)
        assert _filled_frames(scene, hole_error=255) == [is_filled] * FRAMES
    # The same of any hole.
    _set_probability(scene, 0.24)
    assert _filled_frames(scene, hole_error=255, hole_plain_share=1) == [False] * FRAMES
    _set_probability(scene, 0.26)
    assert _filled_frames(scene, hole_error=255, hole_plain_share=1) == [True] * FRAMES


def test_what_is_seen_through_a_hole_shows_the_background_although_its_motion_leaves_no_error(scene):
    """The wall behind the hole stands still and is rough."""
    wall = np.random.default_rng(4).integers(60, 100, (HEIGHT, WIDTH, 3)).astype(np.uint8)
    for t in range(FRAMES):
        around = _at(np.s_[12:28, 19:43], t)
        scene["images"][(t, *around)] = wall[around]
    _set_probability(scene, 0.1)
    assert _filled_frames(scene) == [False] * FRAMES
    assert _filled_frames(scene, hole_roughness=1000) == [True] * FRAMES


def test_what_is_too_small_to_be_plain_needs_the_whole_probability(scene):
    scene["labels"][:] = 0
    scene["labels"][:, 10:30, 10:50] = 1
    scene["labels"][:, 20, 20] = 0
    scene["images"][:] = PLAIN
    for probability, is_filled in ((0.2, False), (0.3, True)):
        scene["foreground"][:] = probability
        assert bool(_fill(scene)[:, 20, 20].all()) == is_filled


@pytest.mark.parametrize(
    ("roughness", "error", "is_filled"),
    [(0, 40, True), (1, 34, True), (1, 37, False), (2, 17, True), (2, 18, False), (4, 9, True), (4, 11, False)],
)
def test_the_plainer_a_hole_the_larger_an_error_says_nothing(scene, roughness, error, is_filled):
    """From half of `hole_roughness` on the limit is 10 grey levels; it is 35 with a roughness of 1, 17.5 with 2."""
    _set_pattern(scene, roughness)
    scene["images"][1] += np.uint8(error)
    assert _filled_frames(scene) == [is_filled] * FRAMES


def test_an_error_of_none_fills_only_what_the_background_explains_exactly(scene):
    _set_pattern(scene, 4)
    assert _filled_frames(scene, hole_error=0) == [True] * FRAMES
    scene["images"][1] += 1
    assert _filled_frames(scene, hole_error=0) == [False] * FRAMES


def test_the_mean_probability_of_a_hole_counts(scene):
    for t in range(FRAMES):
        rows, columns = _at(HOLE, t)
        scene["foreground"][t, rows, columns.start : columns.start + 6] = 0.05
    assert _filled_frames(scene, hole_plain_share=1) == [False] * FRAMES
    assert _filled_frames(scene, hole_plain_share=1, hole_probability=0.2) == [True] * FRAMES


@pytest.mark.parametrize(("low", "is_filled"), [((1,), True), ((0, 2), False)])
def test_a_hole_of_successive_frames_is_decided_by_the_median(scene, low, is_filled):
    _set_probability(scene, 0.01, low)
    assert _filled_frames(scene) == [is_filled] * FRAMES


def test_the_median_error_counts(scene):
    """Of five frames, which stand still, the last two alone show the same in the hole."""
    still = {name: np.repeat(each[1:2], 5, axis=0) for name, each in scene.items()}
    still["flows"][:], still["residual_flows"][:] = 0, 0
    rng = np.random.default_rng(5)
    for t in range(4):
        still["images"][(t, *HOLE)] = rng.integers(0, 256, (8, 12, 3))
    still["images"][4] = still["images"][3]
    assert np.array_equal(_fill(still, hole_roughness=1000), still["labels"])
    still["images"][2] = still["images"][3]
    assert (_fill(still, hole_roughness=1000)[:, *HOLE] == 1).all()


@pytest.mark.parametrize(("down", "is_one"), [(3, True), (5, False)])
def test_holes_that_share_half_their_pixels_are_one(down, is_one, scene):
    """The hole is 8 px high, and `down` px lower in each frame."""
    still = {name: np.repeat(each[1:2], FRAMES, axis=0) for name, each in scene.items()}
    still["flows"][:], still["residual_flows"][:] = 0, 0
    for name in ("labels", "foreground", "images"):
        still[name][0] = np.roll(still[name][1], -down, axis=0)
        still[name][2] = np.roll(still[name][1], down, axis=0)
    for t in (0, 2):
        rows, columns = HOLE
        shift = down * (t - 1)
        still["foreground"][t, rows.start + shift : rows.stop + shift, columns] = 0.01
    found = _fill(still, hole_error=255)
    # Of one hole most frames say no.
    assert bool((found[1][HOLE] == 1).all()) == (not is_one)


def test_specks_do_not_outvote_a_hole(scene):
    """The hole is in pieces, of which most are specks that are likely to move."""
    _set_probability(scene, 0.02)
    still = {name: np.repeat(each[1:2], FRAMES, axis=0) for name, each in scene.items()}
    still["flows"][:], still["residual_flows"][:] = 0, 0
    rows, columns = HOLE
    still["labels"][0::2, rows, columns.start + 1 : columns.start + 4 : 2] = 1
    still["labels"][0::2, rows.start + 1 : rows.stop : 2, columns.start : columns.start + 3] = 1
    still["foreground"][0::2, rows, columns.start : columns.start + 3] = 0.3
    assert np.array_equal(_fill(still), still["labels"])


def test_holes_of_two_objects_at_one_place_are_decided_apart(scene):
    still = {name: np.repeat(each[1:2], FRAMES, axis=0) for name, each in scene.items()}
    still["flows"][:], still["residual_flows"][:] = 0, 0
    still["labels"][1][still["labels"][1] > 0] = 2
    still["foreground"][1][HOLE] = 0.01
    assert [bool((found[HOLE] > 0).all()) for found in _fill(still)] == [True, False, True]


def test_a_hole_that_is_away_for_a_frame_is_another_one(scene):
    still = {name: np.repeat(each[1:2], FRAMES, axis=0) for name, each in scene.items()}
    still["flows"][:], still["residual_flows"][:] = 0, 0
    still["labels"][1][HOLE] = 1
    still["foreground"][2][HOLE] = 0.01
    assert [bool((found[HOLE] > 0).all()) for found in _fill(still)] == [True, True, False]


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


def test_how_far_a_hole_is_usually_open_counts(at_the_border):
    """In the last of five frames it is only 4 px deep, and a third of its outline is on the frame's lower side."""
    several = {name: np.concatenate([each, each[:2]]) for name, each in at_the_border.items()}
    several["labels"][:] = 0
    several["labels"][:, -24:, 8:32] = 1
    several["labels"][:-1, -20:, 16:24] = several["labels"][-1, -4:, 16:24] = 0
    assert (_fill(several) > 0).sum() == 5 * 24 * 24
    alone = {name: np.repeat(each[-1:], 3, axis=0) for name, each in several.items()}
    assert np.array_equal(_fill(alone), alone["labels"])


def test_a_hole_that_is_mostly_too_open_is_left(at_the_border):
    """In two of five frames it is 20 px deep; in the others 4 px, so that a third of its outline is open."""
    several = {name: np.concatenate([each, each[:2]]) for name, each in at_the_border.items()}
    several["labels"][:] = 0
    several["labels"][:, -24:, 8:32] = 1
    several["labels"][:2, -20:, 16:24] = several["labels"][2:, -4:, 16:24] = 0
    assert np.array_equal(_fill(several), several["labels"])


def test_what_is_open_to_two_sides_of_the_frame_is_no_hole(at_the_border):
    """The object cuts off a corner of the frame."""
    at_the_border["labels"][:] = 0
    corner = at_the_border["labels"][:, -20:, -20:]
    corner[:] = 1
    corner[:, 4:, 4:] = 0
    assert np.array_equal(_fill(at_the_border, hole_border=0.5), at_the_border["labels"])


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
