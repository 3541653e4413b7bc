"""Similarities of an object's points from one frame to the next."""

import numpy as np
import pytest

from moseg.tasks.object_points.similarities import expect_next, fit_similarities, fit_similarity, move

CENTRE = np.array([100.0, 60.0])
RNG = np.random.default_rng(3)
PLANE = RNG.uniform(-2, 2, (20, 2))
"""Points of a plane that faces the camera, metres."""


def _seen(frame, depth=20.0, velocity=(0.4, -0.1, -3.0)):
    place, z = PLANE + np.array(velocity[:2]) * frame, depth + velocity[2] * frame
    return (CENTRE + 300 * place / z).astype(np.float32)


@pytest.mark.parametrize("velocity", [(0.4, -0.1, -3.0), (0.0, 0.0, 2.0), (0.5, 0.2, 0.0)])
def test_the_next_motion_of_what_has_a_constant_velocity_is_expected_exactly(velocity):
    frames = [_seen(frame, velocity=velocity) for frame in range(3)]
    similarity, agrees = fit_similarity(frames[0], frames[1], 0.5, 5)
    assert agrees.all()
    np.testing.assert_allclose(move(expect_next(similarity, CENTRE, 1.6), frames[1]), frames[2], atol=0.05)


def test_growth_beyond_the_largest_counts_as_the_largest():
    doubled = np.hstack([2.5 * np.eye(2), (-1.5 * CENTRE)[:, None]])
    expected = expect_next(doubled, CENTRE, 1.6)
    np.testing.assert_allclose(expected[:, :2], np.eye(2) / 0.4)
    np.testing.assert_allclose(move(expected, CENTRE[None]), CENTRE[None], atol=1e-3)


def test_each_motion_is_fitted_to_the_points_that_agree_with_none_before_it():
    points = RNG.uniform(0, 200, (30, 2)).astype(np.float32)
    moved = points + np.where(np.arange(30)[:, None] < 18, [12.0, 0.0], [0.0, -9.0]).astype(np.float32)
    found = fit_similarities(points, moved, 1.0, 5, 3)
    assert len(found) == 2
    np.testing.assert_allclose(move(found[0], points[:18]), moved[:18], atol=0.01)
    np.testing.assert_allclose(move(found[1], points[18:]), moved[18:], atol=0.01)
    assert len(fit_similarities(points, moved, 1.0, 5, 1)) == 1


@pytest.mark.parametrize("number", [0, 1, 4])
def test_too_few_points_show_no_motion(number):
    points = PLANE[:number].astype(np.float32)
    assert fit_similarity(points, points, 1.0, 5) is None
    assert fit_similarities(points, points, 1.0, 5, 3) == []
