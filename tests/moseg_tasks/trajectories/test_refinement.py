"""Laws of moving pieces and trajectories between groups."""

import numpy as np
import pytest

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.metrics.clustering_error import clustering_error
from moseg.tasks.trajectories.energy import Energy, normalised_cut, normalised_cut_gradient
from moseg.tasks.trajectories.refinement import refine_groupings


@pytest.fixture
def case(rigid_clip):
    """A clip of two motions and its energy, with an affinity by motion that is weak."""
    clip = rigid_clip((60, 40), num_frames=12, hidden=0)
    kernel = 0.5 + 0.5 * (clip.labels[:, None] == clip.labels)
    return clip, Energy(
        clip.points, clip.visible, kernel.astype(np.float32), EnergyParams(spacing=0.3, motion_weight=0)
    )


def test_single_trajectories_return_to_their_motion(case):
    clip, energy = case
    spoilt = clip.labels.copy()
    spoilt[::9] = 1 - spoilt[::9]
    start = energy.minimum([spoilt])
    refined = refine_groupings([start], energy, [], 8, 6)[0]
    assert refined.energy < start.energy
    assert clustering_error(refined.labels, clip.labels) == 0


def test_a_piece_in_the_wrong_group_moves_as_a_whole(case):
    clip, energy = case
    pieces = np.arange(100) // 20
    spoilt = np.where(pieces == 2, 1, clip.labels)
    refined = refine_groupings([energy.minimum([spoilt])], energy, [pieces], 1, 6)[0]
    assert clustering_error(refined.labels, clip.labels) == 0


def test_a_minimum_is_left_as_it_is_and_no_group_disappears(case):
    clip, energy = case
    best = energy.minimum([clip.labels])
    assert refine_groupings([best], energy, [np.arange(100) // 10], 8, 6)[0].energy == best.energy
    one = energy.minimum([np.zeros(100, int)])
    assert refine_groupings([one], energy, [np.arange(100) // 10], 8, 6)[0] is one
    few = energy.minimum([(np.arange(100) < 2).astype(int)])
    assert set(refine_groupings([few], energy, [np.arange(100) // 10], 8, 6)[0].labels) == {0, 1}


def test_the_gradient_of_the_cut_predicts_a_move():
    rng = np.random.default_rng(0)
    kernel = rng.random((200, 200))
    kernel += kernel.T
    labels = rng.integers(0, 3, 200)
    slope = normalised_cut_gradient(kernel, labels)
    moved = labels.copy()
    moved[7] = (labels[7] + 1) % 3
    change = normalised_cut(kernel, moved) - normalised_cut(kernel, labels)
    assert slope[7, moved[7]] - slope[7, labels[7]] == pytest.approx(change, abs=2e-3)
