"""Straight edges, along which a tracker slips, and corners."""

import numpy as np

from moseg.tasks.roundness import roundness

NOISE = np.random.default_rng(1).integers(0, 255, (60, 80)).astype(np.uint8)
POINTS = np.float32([[20, 20], [40.5, 30.25], [1, 58]])


def test_a_straight_edge_is_not_round_and_a_corner_is():
    image = np.zeros((60, 80), np.uint8)
    image[:30, :40] = 200
    edge, corner = roundness(image, np.float32([[40, 10], [40, 30]]), 15)
    assert edge < 0.01
    assert corner > 0.3


def test_roundness_does_not_depend_on_the_other_points():
    image = np.kron(NOISE[:15, :20], np.ones((4, 4), np.uint8))
    together = roundness(image, POINTS, 9)
    np.testing.assert_allclose(together, [roundness(image, point[None], 9)[0] for point in POINTS], rtol=1e-5)


def test_no_points_have_no_roundness():
    assert roundness(np.zeros((60, 80), np.uint8), np.zeros((0, 2), np.float32), 15).shape == (0,)
