import cv2
import numpy as np
import pytest
from pydantic import ValidationError

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.parallax import Parallax
from moseg.tasks.rigidity.patch_test import AllowedParallax, compare_patches

PARAMS = RigidityParams()
SIDE = 160
GRID = np.stack(np.meshgrid(np.arange(30.0, 120, 10), np.arange(30.0, 120, 10)), axis=-1).reshape(-1, 2)
"""Tracks in the first frame, xy, px."""
POLE = 80
"""First column of a bright pole before a wall of slanted stripes."""
SLOPE = 0.5
"""Rows that a stripe falls by per column."""


@pytest.fixture(scope="module")
def image():
    noise = np.random.default_rng(0).normal(size=(SIDE, SIDE)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 1.5)
    return np.clip(128 + 50 * smooth / smooth.std(), 0, 255).astype(np.uint8)


@pytest.fixture
def compare(image):
    """Function that tests tracks of a frame that moves by `shift`, tracked by `tracked`, px; lines run along x."""

    def call(shift, tracked, least=0.0, largest=1e4, images=None, points0=GRID, params=PARAMS, others=()):
        points1 = points0 + tracked
        count = len(points0)
        towards = np.tile([1.0, 0.0], (count, 1))
        left = points1 - points0
        ones = np.ones(count)
        parallax = Parallax(left[:, 0], -left[:, 1], left[:, 0], points0, towards, ones, 0 * ones)
        allowed = AllowedParallax(np.full(count, least), np.full(count, largest))
        if images is None:
            shifted = np.array([[1.0, 0, shift[0]], [0, 1.0, shift[1]]])
            images = image, cv2.warpAffine(image, shifted, (SIDE, SIDE))
        return compare_patches(*images, points0, points1, parallax, allowed, np.arange(count), params, others)

    return call


def test_a_static_point_is_explained(compare):
    assert np.abs(compare((3, 0), (3.0, 0.0))).max() < 0.2


def test_a_slip_across_the_line_is_excused(compare):
    # The patch is found on its line, better than where the tracker put it.
    assert (np.median(compare((3, 0), (3.0, 2.5)), axis=0) < -0.5).all()


def test_a_point_that_moves_across_its_line_is_not_excused(compare):
    found = compare((3, 2), (3.0, 2.0))
    assert (np.median(found, axis=0) > 1).all()
    assert found.min() > 0


def test_a_point_behind_infinity_or_the_ground_is_not_excused(compare):
    assert (np.median(compare((-2, 0), (-2.0, 0.0)), axis=0) > 1).all()
    assert (np.median(compare((3, 0), (3.0, 0.0), least=5.0), axis=0) > 1).all()


def test_a_point_nearer_than_its_foot_is_not_excused(compare):
    assert (np.median(compare((6, 0), (6.0, 0.0), largest=4.0), axis=0) > 1).all()


def before_a_wall(pole_shift, wall_shift):
    """Return a frame uint8 (y, x) of a pole before a wall, each moved along x, px."""
    rng = np.random.default_rng(1)
    profile = cv2.GaussianBlur(rng.normal(size=(600, 1)), (1, 9), 1.5)[:, 0]
    y, x = np.mgrid[:SIDE, :SIDE]
    height = y - SLOPE * (x - wall_shift) + 200
    wall = np.interp(height, np.arange(len(profile)), 90 + 25 * profile / profile.std())
    return np.clip(np.where(x >= POLE + pole_shift, 220, wall), 0, 255).astype(np.uint8)


def test_a_corner_of_two_static_surfaces_is_excused_by_the_strict_test_alone(compare):
    # Stripes end at the pole: where they seem to end, a tracker finds the same corner, off its epipolar line.
    pole, wall = 6, 1
    images = before_a_wall(0, 0), before_a_wall(pole, wall)
    corners = np.column_stack([np.full(40, POLE), np.arange(40.0, 120, 2)])
    test, strict_test = compare(None, (pole, SLOPE * (pole - wall)), images=images, points0=corners).T
    assert np.median(test) > 1
    assert np.mean(test > 0.5) > 0.9
    assert np.mean(np.abs(strict_test) < 0.2) > 0.9


@pytest.mark.parametrize("wall", [1, 20])
def test_a_corner_of_a_near_surface_and_one_far_behind_it_is_excused(compare, wall):
    pole = 40
    images = before_a_wall(0, 0), before_a_wall(pole, wall)
    corners = np.column_stack([np.full(40, POLE), np.arange(40.0, 120, 2)])

    def strict_test(**changes):
        params = RigidityParams(**{"test_behind": 24, **changes.pop("params", {})})
        tracked = pole, SLOPE * (pole - wall)
        return compare(None, tracked, images=images, points0=corners, params=params, **changes)[:, 1]

    assert np.median(strict_test()) < 0.5 < 1 < np.median(strict_test(params={"test_behind": 0}))
    # Of what seems too near, a surface behind it explains nothing.
    np.testing.assert_array_equal(strict_test(largest=100.0), strict_test(params={"test_behind": 0}))


def test_positions_behind_begin_at_the_farthest_static_point(compare):
    # The wall lies in front of the ground at 15 px, the pole farther in front: 1 px is behind the ground.
    pole, least = 40, 15.0
    corners = np.column_stack([np.full(40, POLE), np.arange(40.0, 120, 2)])
    found = [
        np.median(
            compare(
                None,
                (pole, SLOPE * (pole - wall)),
                least=least,
                images=(before_a_wall(0, 0), before_a_wall(pole, wall)),
                points0=corners,
            )[:, 1]
        )
        for wall in (1, 16)
    ]
    assert found[0] > 1 and found[1] < 0.5


def test_a_mover_is_not_excused_by_what_is_behind_it(compare):
    tracked = 30.0, 3.0
    found, before = (compare((30, 3), tracked, params=RigidityParams(test_behind=count))[:, 1] for count in (24, 0))
    assert np.median(found) > 1 and np.median(found) > 0.8 * np.median(before)


def test_two_rigid_positions_excuse_no_less_than_one(compare):
    for shift, tracked in (((3, 0), (3.0, 1.0)), ((3, 2), (3.0, 2.0)), ((-2, 0), (-2.0, 0.0))):
        test, strict_test = compare(shift, tracked).T
        assert (strict_test <= test).all()


def faint(image, contrast, where=slice(None)):
    """Return a frame uint8 (y, x) whose columns with tracks, or some, have a deviation of `contrast` grey levels."""
    grey = np.clip(np.rint(128 + (image.astype(float) - image.mean()) * contrast / image.std()), 0, 255)
    frame = image.copy()
    frame[:, :126][:, where] = grey[:, :126][:, where]
    return frame


@pytest.mark.parametrize(("contrast", "is_excused"), [(5, True), (14, False)])
def test_what_is_faint_and_stands_still_in_the_picture_is_excused(compare, image, contrast, is_excused):
    """A rigid point there would have moved by 4 px or more."""
    still = faint(image, contrast)
    found = np.median(compare(None, (0.0, 0.0), least=4.0, images=(still, still)), axis=0)
    assert (np.abs(found) < 0.1).all() == is_excused
    assert (found > 1).all() != is_excused
    without = PARAMS.model_copy(update={"test_still_contrast": 0.0})
    assert (compare(None, (0.0, 0.0), least=4.0, images=(still, still), params=without) > 1).mean() > 0.9


def test_what_stands_still_for_the_pair_alone_is_not_excused(compare, image):
    """In one of the frames before or after it must stand there too."""
    still = faint(image, 5)
    gone = np.roll(still, 10, axis=0)
    for others, is_excused in (((gone, gone), False), ((gone, still, gone), True), ((still,), True), ((), True)):
        found = compare(None, (0.0, 0.0), least=4.0, images=(still, still), others=others)
        assert (np.abs(np.median(found, axis=0)) < 0.1).all() == is_excused
        assert (np.median(found, axis=0) > 1).all() != is_excused


def test_what_stands_still_at_other_times_alone_is_not_excused(compare, image):
    still = faint(image, 5)
    second = np.roll(still, 2, axis=0)
    found = compare(None, (0.0, 2.0), least=4.0, images=(still, second), others=(still,))
    assert (np.median(found, axis=0) > 1).all()


def test_what_stands_still_near_a_rigid_position_is_not_excused(compare, image):
    still = faint(image, 5)
    assert (np.median(compare(None, (0.0, 0.0), least=3.5, images=(still, still)), axis=0) > 1).all()


def test_each_patch_is_faint_or_not_by_itself(compare, image):
    still = faint(image, 5, where=slice(74))
    found = compare(None, (0.0, 0.0), least=4.0, images=(still, still))
    left = GRID[:, 0] < 70
    assert (np.abs(found[left]) < 0.3).all()
    assert (np.median(found[GRID[:, 0] >= 80], axis=0) > 1).all()


def test_what_is_faint_and_moves_as_the_scene_does_is_explained(compare, image):
    first = faint(image, 5)
    second = cv2.warpAffine(first, np.array([[1.0, 0, 6], [0, 1.0, 0]]), (SIDE, SIDE))
    assert np.abs(np.median(compare(None, (6.0, 0.0), least=5.0, images=(first, second)), axis=0)).max() < 0.2


def test_a_quarter_of_a_pixel_is_still(compare, image):
    first = faint(image, 7)
    second = cv2.warpAffine(first, np.array([[1.0, 0, 0], [0, 1.0, 0.25]]), (SIDE, SIDE))
    found = np.median(compare(None, (0.0, 0.25), least=4.0, images=(first, second)), axis=0)
    assert (np.abs(found) < 0.02).all()


@pytest.mark.parametrize(("beside", "is_excused"), [(60, True), (14, False)])
def test_what_is_faint_depends_on_the_noise(compare, beside, is_excused):
    """In a frame of little contrast, noise is taken to be less, and patches of seven grey levels are not faint."""
    signs = np.kron(np.random.default_rng(3).choice([-1, 1], (54, 54)), np.ones((3, 3)))[:SIDE, :SIDE]
    still = np.full((SIDE, SIDE), 128, np.uint8)
    still[25:56, 25:56] = 128 + 7 * signs[25:56, 25:56]
    still[:, 138:] = 128 + beside * signs[:, 138:]
    places = GRID[(GRID < 60).all(axis=1)]
    found = np.median(compare(None, (0.0, 0.0), least=4.0, images=(still, still), points0=places), axis=0)
    assert (np.abs(found) < 0.1).all() == is_excused
    assert (found > 1).all() != is_excused


@pytest.mark.parametrize(("moved", "least", "largest"), [(0.25, -0.1, 0.1), (1.0, 0.3, 2.0), (2.0, 1.0, 3.0)])
def test_what_is_faint_and_moves_in_the_picture_is_not_excused(compare, image, moved, least, largest):
    """Of what moves by less than a pixel, the difference is little more than noise."""
    first = faint(image, 5)
    second = cv2.warpAffine(first, np.array([[1.0, 0, 0], [0, 1.0, moved]]), (SIDE, SIDE))
    found = np.median(compare(None, (0.0, moved), images=(first, second)), axis=0)
    assert (found > least).all() and (found < largest).all()


@pytest.mark.parametrize("share", [1 / 3, 1 / 8, 1 / 16])
def test_what_stands_still_in_a_dark_frame_is_not_faint_for_that(compare, image, share):
    dark = np.rint(image * share).astype(np.uint8)
    assert (np.median(compare(None, (0.0, 0.0), least=4.0, images=(dark, dark)), axis=0) > 1).all()


def test_bare_ground_is_always_excused(compare):
    bare = np.full((SIDE, SIDE), 90, np.uint8)
    np.testing.assert_array_equal(compare((0, 0), (3.0, 4.0), images=(bare, bare)), 0)


def test_a_change_of_brightness_changes_nothing(compare, image):
    brighter = np.roll(image, 3, axis=1) // 2 + 60
    darker = np.roll(image, 3, axis=1) // 2
    found = [compare((3, 0), (3.0, 1.0), images=(image // 2, second)) for second in (brighter, darker)]
    np.testing.assert_allclose(*found, atol=1e-3)


def test_what_moves_in_the_dark_is_not_excused(compare, image):
    """Noise of as many grey levels as by day would excuse most of it."""
    dark = [np.roll(image, shift, axis=(0, 1)) // 25 for shift in ((0, 0), (2, 3))]
    found, excused = (
        np.median(compare(None, (3.0, 2.5), images=dark, params=params), axis=0)
        for params in (PARAMS, RigidityParams(test_contrast=100.0))
    )
    assert (found > 1).all() and (excused < 0.5).all()


def test_noise_by_day_does_not_depend_on_contrast(compare, image):
    images = image // 4, np.roll(image // 4, (2, 3), axis=(0, 1))
    found = [compare(None, (3.0, 2.5), images=images, params=RigidityParams(test_contrast=c)) for c in (0.6, 100.0)]
    np.testing.assert_array_equal(*found)


@pytest.mark.parametrize(("name", "largest"), [("test_span", 255), ("test_half", 90), ("test_behind", 500)])
def test_the_largest_patch_and_the_longest_search_can_be_compared(compare, name, largest):
    params = RigidityParams(**{"test_span": 1, "test_half": 1, name: largest})
    assert np.isfinite(compare((3, 0), (3.0, 0.0), params=params)).all()
    with pytest.raises(ValidationError, match=f"less than or equal to {largest}"):
        RigidityParams(**{name: largest + 1})


def test_no_tracks_are_no_test(image):
    nothing = np.zeros((0, 2))
    parallax = Parallax(*[nothing[:, 0]] * 3, nothing, nothing, *[nothing[:, 0]] * 2)
    allowed = AllowedParallax(nothing[:, 0], nothing[:, 0])
    assert compare_patches(image, image, nothing, nothing, parallax, allowed, np.zeros(0, int), PARAMS).shape == (0, 2)
