"""Flow has the colours of the Middlebury benchmark."""

import colorsys

import numpy as np
import pytest

from moseg.workflows.exports.draw_flow import UNKNOWN_FLOW, colour_flow, draw_flow_wheel


def colour(u, v, longest=1.0):
    return tuple(colour_flow(np.array([[[u, v]]], np.float32), longest)[0, 0].tolist())


# Values of the published coding: hue 0, 13.5, 27 and 40.5 of the wheel's 55.
@pytest.mark.parametrize(
    ("vector", "published"),
    [((1, 0), (255, 0, 0)), ((0, 1), (255, 229, 0)), ((-1, 0), (0, 209, 255)), ((0, -1), (88, 0, 255))],
    ids=["right", "down", "left", "up"],
)
def test_directions_have_the_published_hues(vector, published):
    np.testing.assert_allclose(colour(*vector), published, atol=2)


def test_longer_vectors_are_more_saturated():
    shades = [colorsys.rgb_to_hsv(*(level / 255 for level in colour(length, 0))) for length in (0.25, 0.5, 0.75, 1.0)]
    assert [saturation for _, saturation, _ in shades] == pytest.approx([0.25, 0.5, 0.75, 1.0], abs=0.01)
    assert {hue for hue, _, _ in shades} == {0.0}
    assert all(value == 1 for _, _, value in shades)


def test_no_motion_is_white_and_the_scale_is_the_longest_vector():
    assert colour(0, 0) == (255, 255, 255)
    assert colour(3, 4, longest=10) == colour(0.3, 0.4)


def test_vectors_beyond_the_scale_are_darker_than_any_within():
    assert max(colour(1.5, 0)) == pytest.approx(0.75 * 255, abs=1)
    assert colour(1.5, 0) == colour(150, 0)


@pytest.mark.parametrize("unknown", [np.nan, np.inf])
def test_unknown_flow_is_black_and_its_neighbours_keep_their_colour(unknown):
    drawn = colour_flow(np.array([[[unknown, 0], [1, 0]]], np.float32), 1.0)
    assert tuple(drawn[0, 0]) == UNKNOWN_FLOW
    assert tuple(drawn[0, 1]) == (255, 0, 0)


def test_a_sequence_without_motion_has_a_scale():
    assert (colour_flow(np.zeros((2, 3, 2), np.float32), 0.0) == 255).all()


def test_the_wheel_shows_each_vector_from_its_centre():
    wheel = draw_flow_wheel(65)
    assert wheel.shape == (65, 65, 4)
    assert wheel[0, 0, 3] == wheel[64, 64, 3] == 0
    assert wheel[32, 32].tolist() == [255, 255, 255, 255]
    for place, vector in (((32, 63), (1, 0)), ((63, 32), (0, 1)), ((32, 1), (-1, 0)), ((1, 32), (0, -1))):
        assert wheel[place][3] == 255
        np.testing.assert_allclose(wheel[place][:3].astype(int), colour(*vector), atol=12)
