"""Errors differ by colour on every frame; void has none."""

from itertools import combinations

import numpy as np
import pytest

from moseg.workflows.exports.draw_errors import (
    DIMMING,
    ERROR_COLOURS,
    OPACITY,
    POINT_RADIUS,
    PointLabels,
    draw_errors,
    draw_point_errors,
)

VOID = 255
IMAGE = np.random.default_rng(0).integers(0, 256, (60, 80, 3)).astype(np.uint8)
DIM = draw_errors(IMAGE, np.zeros((60, 80), np.uint16), np.zeros((60, 80), np.uint16))


def made_up(frame_colour):
    """A frame of one colour, a prediction and a truth with all four cases and a void column."""
    image = np.full((1, 5, 3), frame_colour, np.uint8)
    labels = np.array([[0, 7, 9, 0, 7]], np.uint16)
    truth = np.array([[0, 1, 0, 2, VOID]], np.uint8)
    return image, labels, truth


def tinted(kind, grey):
    return (1 - OPACITY) * DIMMING * grey + OPACITY * np.array(ERROR_COLOURS[kind])


@pytest.mark.parametrize("grey", [0, 120, 255])
def test_each_error_has_its_colour_over_the_dimmed_frame(grey):
    drawn = draw_errors(*made_up(grey), void=VOID)[0].astype(float)
    static = [DIMMING * grey] * 3
    expected = [static, *(tinted(kind, grey) for kind in ERROR_COLOURS), static]
    np.testing.assert_allclose(drawn, expected, atol=1)


def test_the_colours_are_named_in_order():
    assert list(ERROR_COLOURS) == ["true positive", "false positive", "false negative"]


def test_without_a_void_label_every_true_label_moves():
    drawn = draw_errors(*made_up(120))[0].astype(float)
    np.testing.assert_allclose(drawn[4], tinted("true positive", 120), atol=1)


def test_pixels_that_move_in_both_are_right_for_any_object():
    image, labels, truth = made_up(60)
    swapped = np.where(labels == 7, 9, np.where(labels == 9, 7, 0)).astype(np.uint16)
    np.testing.assert_array_equal(draw_errors(image, swapped, truth, VOID), draw_errors(image, labels, truth, VOID))


def test_the_dimmed_frame_has_no_error_colour():
    drawn = draw_errors(*made_up((250, 160, 0)), void=VOID)
    assert np.ptp(drawn[0, 0]) == 0
    assert drawn[0, 0].max() < 100


# Machado, Oliveira, Fernandes, "A Physiologically-based Model for Simulation of Color Vision Deficiency", TVCG 2009,
# severity 1.0, on linear RGB.
DICHROMACIES = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


@pytest.mark.parametrize("vision", DICHROMACIES)
@pytest.mark.parametrize("grey", [0, 255])
def test_drawn_errors_differ_for_the_colour_blind_too(vision, grey):
    drawn = draw_errors(*made_up(grey), void=VOID)[0, :4] / 255
    linear = np.where(drawn <= 0.04045, drawn / 12.92, ((drawn + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ np.transpose(DICHROMACIES[vision]), 0, 1)
    # CIE 1976 L*a*b* with the white of sRGB; a difference of 2.3 is just noticeable.
    xyz = seen @ np.array([[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]])
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116).T
    lab = np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)
    assert min(np.linalg.norm(one - other) for one, other in combinations(lab, 2)) > 20


def test_each_point_has_the_colour_of_its_kind_and_static_points_have_none():
    points = np.array([[10, 10], [30, 10], [50, 10], [70, 10]], float)
    labelled = PointLabels(points, np.uint16([3, 4, 0, 0]), np.uint16([2, 0, 2, 0]), (60, 80))
    drawn = draw_point_errors(IMAGE, labelled)
    assert [tuple(drawn[10, x]) for x in (10, 30, 50)] == list(ERROR_COLOURS.values())
    np.testing.assert_array_equal(drawn[:, 60:], DIM[:, 60:])
    y, x = np.nonzero((drawn != DIM).any(axis=-1))
    assert max(np.hypot(np.subtract.outer(x, points[:3, 0]), (y - 10)[:, None]).min(axis=1)) <= POINT_RADIUS + 0.5


def test_points_keep_their_place_in_a_smaller_picture():
    labelled = PointLabels(np.array([[100.5, 60.5]]), np.uint16([1]), np.uint16([1]), (120, 160))
    y, x = np.nonzero((draw_point_errors(IMAGE, labelled) == 255).all(axis=-1))
    assert (x.mean(), y.mean()) == (50, 30)


def test_errors_lie_above_correct_points():
    points = np.array([[20, 20], [20, 20]], float)
    labelled = PointLabels(points, np.uint16([0, 1]), np.uint16([1, 1]), (60, 80))
    assert tuple(draw_point_errors(IMAGE, labelled)[20, 20]) == ERROR_COLOURS["false negative"]
