"""Maps are colours on one scale, lighter for larger values."""

import cv2
import numpy as np
import pytest

from moseg.workflows.exports.colour_maps import DEPTH_COLOURS, SOFT_COLOURS, colour_inverse_depth, draw_colour_bar


def lightness(image):
    return cv2.cvtColor(image, cv2.COLOR_RGB2LAB)[..., 0].astype(int)


def test_near_pixels_are_lighter():
    depth = np.linspace(0, 4, 9, dtype=np.float32)[None]
    shades = lightness(colour_inverse_depth(depth, 1.0, 3.0))[0]
    assert (np.diff(shades[2:7]) > 0).all()
    assert shades[0] == shades[2]
    assert shades[6] == shades[8]


def test_a_flat_scene_has_one_colour():
    drawn = colour_inverse_depth(np.full((3, 4), 2.0, np.float32), 2.0, 2.0)
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) == 1


@pytest.mark.parametrize("colours", [SOFT_COLOURS, DEPTH_COLOURS])
def test_the_bar_grows_lighter_from_its_smallest_to_its_largest_value(colours):
    bar = draw_colour_bar((4, 100), colours)
    assert bar.shape == (4, 100, 3)
    assert (np.diff(lightness(bar)[0, ::10]) > 0).all()
