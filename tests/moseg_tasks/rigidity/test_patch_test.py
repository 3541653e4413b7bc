import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.parallax import Parallax
from moseg.tasks.rigidity.patch_test import AllowedParallax, compare_patches

PARAMS = RigidityParams()
SIDE = 160


@pytest.fixture(scope="module")
def image():
    noise = np.random.default_rng(0).normal(size=(SIDE, SIDE)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 1.5)
    return np.clip(128 + 50 * smooth / smooth.std(), 0, 255).astype(np.uint8)


@pytest.fixture
def compare(image):
    """Function that tests tracks of a frame that moves by `shift`, tracked by `tracked`, px; lines run along x."""

    def call(shift, tracked, least=0.0, largest=1e4, images=None):
        x, y = (axis.ravel() for axis in np.meshgrid(np.arange(30.0, 120, 10), np.arange(30.0, 120, 10)))
        points0 = np.column_stack([x, y])
        points1 = points0 + tracked
        count = len(points0)
        moved = cv2.warpAffine(image, np.array([[1.0, 0, shift[0]], [0, 1.0, shift[1]]]), (SIDE, SIDE))
        towards = np.tile([1.0, 0.0], (count, 1))
        left = points1 - points0
        ones = np.ones(count)
        parallax = Parallax(left[:, 0], -left[:, 1], left[:, 0], points0, towards, ones, 0 * ones)
        allowed = AllowedParallax(np.full(count, least), np.full(count, largest))
        images = (image, moved) if images is None else images
        return compare_patches(*images, points0, points1, parallax, allowed, np.arange(count), PARAMS)

    return call


def test_a_static_point_is_explained(compare):
    assert np.abs(compare((3, 0), (3.0, 0.0))).max() < 0.2


def test_a_slip_across_the_line_is_excused(compare):
    # The patch is found on its line, better than where the tracker put it.
    assert np.median(compare((3, 0), (3.0, 2.5))) < -0.5


def test_a_point_that_moves_across_its_line_is_not_excused(compare):
    assert np.median(compare((3, 2), (3.0, 2.0))) > 1
    assert compare((3, 2), (3.0, 2.0)).min() > 0


def test_a_point_behind_infinity_or_the_ground_is_not_excused(compare):
    assert np.median(compare((-2, 0), (-2.0, 0.0))) > 1
    assert np.median(compare((3, 0), (3.0, 0.0), least=5.0)) > 1


def test_a_point_nearer_than_its_foot_is_not_excused(compare):
    assert np.median(compare((6, 0), (6.0, 0.0), largest=4.0)) > 1


def test_bare_ground_is_always_excused(compare):
    bare = np.full((SIDE, SIDE), 90, np.uint8)
    np.testing.assert_array_equal(compare((0, 0), (3.0, 4.0), images=(bare, bare)), 0)


def test_a_change_of_brightness_changes_nothing(compare, image):
    brighter = np.roll(image, 3, axis=1) // 2 + 60
    darker = np.roll(image, 3, axis=1) // 2
    found = [compare((3, 0), (3.0, 1.0), images=(image // 2, second)) for second in (brighter, darker)]
    np.testing.assert_allclose(*found, atol=1e-3)


def test_no_tracks_are_no_test(image):
    nothing = np.zeros((0, 2))
    parallax = Parallax(*[nothing[:, 0]] * 3, nothing, nothing, *[nothing[:, 0]] * 2)
    allowed = AllowedParallax(nothing[:, 0], nothing[:, 0])
    assert compare_patches(image, image, nothing, nothing, parallax, allowed, np.zeros(0, int), PARAMS).shape == (0,)
