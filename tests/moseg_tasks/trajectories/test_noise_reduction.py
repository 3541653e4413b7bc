"""Laws of the reduction of noise."""

import numpy as np
import pytest

from moseg.schemas.parameters import NoiseReductionParams
from moseg.tasks.trajectories import reduce_noise

PARAMS = NoiseReductionParams()


def _noisy(rigid_clip, noise, hidden=0.0, num_frames=24):
    clip = rigid_clip(sizes=(90, 40), num_frames=num_frames, noise=0.0, hidden=hidden)
    return clip, clip.points + np.random.default_rng(1).normal(0, noise, clip.points.shape)


def _rms(points, clip, rows=slice(None)):
    return float(np.sqrt(np.mean((points - clip.points)[rows][clip.visible[rows]] ** 2)))


@pytest.mark.parametrize("noise", [0.5, 1.0, 2.0])
def test_most_of_the_noise_is_removed(rigid_clip, noise):
    clip, points = _noisy(rigid_clip, noise)
    assert _rms(reduce_noise(points, clip.visible, PARAMS).points, clip) < 0.6 * noise


def test_points_with_little_noise_stay_as_they_are(rigid_clip):
    clip, points = _noisy(rigid_clip, 0.05)
    found = reduce_noise(points, clip.visible, PARAMS)
    assert np.array_equal(found.points, points)
    assert not found.is_stray.any()


def test_few_frames_stay_as_they_are(rigid_clip):
    clip, points = _noisy(rigid_clip, 1.0, num_frames=PARAMS.min_frames - 1)
    assert np.array_equal(reduce_noise(points, clip.visible, PARAMS).points, points)


def test_trajectories_that_slip_are_strays_and_do_not_count_as_noise(rigid_clip):
    _, points = _noisy(rigid_clip, 0.05)
    walks = np.cumsum(np.random.default_rng(2).normal(0, 3, (60, points.shape[1], 2)), axis=1) + 200
    both = np.concatenate([points, walks])
    seen = np.ones(both.shape[:2], bool)
    found = reduce_noise(both, seen, PARAMS)
    assert np.array_equal(found.points, both)
    assert np.array_equal(found.is_stray, np.arange(len(both)) >= len(points))


def test_hidden_points_stay_and_the_visible_ones_of_lost_tracks_gain(rigid_clip):
    clip, points = _noisy(rigid_clip, 1.0)
    clip.visible[100:, 15:] = False
    found = reduce_noise(points, clip.visible, PARAMS).points
    assert np.array_equal(found[~clip.visible], points[~clip.visible])
    assert _rms(found, clip, slice(100, None)) < 0.8
    assert _rms(found, clip) < 0.6


def test_a_long_clip_is_read_in_windows(rigid_clip):
    clip, points = _noisy(rigid_clip, 1.0, num_frames=24)
    in_windows = NoiseReductionParams(max_frames=12)
    assert _rms(reduce_noise(points, clip.visible, in_windows).points, clip) < 0.75


def test_nothing_is_asked_of_a_clip_without_points():
    empty = np.zeros((0, 20, 2)), np.zeros((0, 20), bool)
    assert reduce_noise(*empty, PARAMS).points.shape == (0, 20, 2)
    hidden = np.zeros((5, 20, 2)), np.zeros((5, 20), bool)
    assert np.array_equal(reduce_noise(*hidden, PARAMS).points, hidden[0])
