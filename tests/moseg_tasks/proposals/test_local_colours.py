import math

import numpy as np
import pytest

from moseg.schemas.parameters import AppearanceParams, LocalColourParams
from moseg.tasks.appearance import colour_bins
from moseg.tasks.proposals.local_colours import local_colour_ratio

PARAMS = LocalColourParams()
RED, GREY = (200, 60, 60), (128, 128, 128)


def two_scenes() -> tuple[np.ndarray, np.ndarray]:
    """Image and objects: to the left a red one on grey, to the right a grey one on red, 40 px each."""
    image, is_object = np.full((40, 160, 3), GREY, np.uint8), np.zeros((40, 160), bool)
    image[:, 80:] = RED
    for start, colour in ((20, RED), (100, GREY)):
        image[:, start : start + 40] = colour
        is_object[:, start : start + 40] = True
    return image, is_object


def test_the_same_colour_is_of_the_object_at_one_place_and_of_the_background_at_another():
    image, is_object = two_scenes()
    ratio = local_colour_ratio(image, is_object.astype(np.float32), is_object, PARAMS)
    assert ratio.dtype == np.float32 and ratio.shape == is_object.shape
    beside = np.zeros_like(is_object)
    for border in (20, 60, 100, 140):
        beside[:, border - 6 : border + 6] = True
    assert (ratio[is_object & beside] > 1.5).all() and (ratio[~is_object & beside] < -1.5).all()


def test_a_window_with_one_side_alone_says_nothing():
    image, is_object = two_scenes()
    for certain in (0, 1):
        everywhere = np.full(is_object.shape, certain, np.float32)
        assert not local_colour_ratio(image, everywhere, everywhere > 0, PARAMS).any()
    # The middle of an object is far from the background.
    wide = np.zeros_like(is_object)
    wide[:, :120] = True
    ratio = np.abs(local_colour_ratio(image, wide.astype(np.float32), wide, PARAMS))
    assert ratio[:, :60].max() < 0.01 * ratio[:, 100:140].max()


@pytest.mark.parametrize(
    ("columns", "probability"), [(slice(50, 60), 0.5), (slice(62, 70), 1.0)], ids=["uncertain", "of no object"]
)
def test_what_is_uncertain_or_of_no_object_has_no_colours(columns, probability):
    image, is_object = two_scenes()
    foreground = is_object.astype(np.float32)
    foreground[:, columns] = probability
    other = image.copy()
    other[:, columns] = (60, 60, 200)
    ratios = [local_colour_ratio(each, foreground, is_object, PARAMS) for each in (image, other)]
    elsewhere = [np.delete(each, columns, axis=1) for each in ratios]
    np.testing.assert_array_equal(*elsewhere)
    assert np.abs(elsewhere[0]).max() > 1.5


def test_it_is_the_log_ratio_of_the_shares_in_gaussian_windows():
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (7, 9, 3), np.uint8)
    foreground, is_object = rng.random((7, 9), np.float32), rng.random((7, 9)) < 0.5
    params = LocalColourParams(radius=1, levels=4, smoothing=1.0, doubt=0.3, clip=1.5)
    ratio = local_colour_ratio(image, foreground, is_object, params)
    bins = np.unravel_index(colour_bins(image, AppearanceParams(levels=4, texture_levels=1)), (4, 4, 4))
    colours = np.stack(bins, axis=-1).reshape(-1, 3).astype(float)
    places = np.indices((7, 9)).reshape(2, -1).T
    for pixel, place in enumerate(places):
        near = np.exp(-np.square(places - place).sum(axis=1) / 2)
        apart = np.square(colours - colours[pixel]).sum(axis=1)
        alike = np.exp(-apart / 2) * (apart <= 9)
        certainty = 2 * foreground.ravel() - 1
        sides = (np.where(is_object.ravel() & (certainty > 0), certainty, 0), np.minimum(certainty, 0))
        totals = [float(near @ each**2) for each in sides]
        shares = [
            float((near * alike) @ each**2) / total + params.floor for each, total in zip(sides, totals, strict=True)
        ]
        limited = min(max(math.log(shares[0] / shares[1]), -params.clip), params.clip)
        expected = limited * min(totals) / (min(totals) + params.doubt)
        assert ratio[tuple(place)] == pytest.approx(expected, abs=1e-4)


def test_it_does_not_depend_on_how_much_around_the_objects_is_looked_at():
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (50, 60, 3), np.uint8)
    foreground, is_object = np.full((50, 60), 0.5, np.float32), np.zeros((50, 60), bool)
    foreground[20:40, 25:50], is_object[20:40, 25:37] = rng.random((20, 25), np.float32), True
    whole = local_colour_ratio(image, foreground, is_object, PARAMS)
    assert np.abs(whole).max() > 0.1
    for y, x in ((0, 3), (13, 20), (20, 25)):
        part = slice(y, 40), slice(x, 50)
        found = local_colour_ratio(image[part], foreground[part], is_object[part], PARAMS, (y, x))
        np.testing.assert_allclose(found, whole[part], atol=1e-4)
