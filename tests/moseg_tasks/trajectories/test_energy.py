"""Laws of the energy that groupings compete by."""

import numpy as np
import pytest

from moseg.schemas.parameters import EnergyParams
from moseg.tasks.trajectories.energy import Energy, normalised_cut

BLOCKS = np.kron(np.eye(2), np.ones((3, 3))) + 0.1
SPLIT, ONE = np.repeat([0, 1], 3), np.zeros(6, int)


def test_a_cut_is_the_share_of_affinity_that_leaves_each_group():
    inside, outside = 3 * 1.1, 3 * 0.1
    assert normalised_cut(BLOCKS, SPLIT) == pytest.approx(2 * outside / (inside + outside))
    assert normalised_cut(BLOCKS, ONE) == pytest.approx(0)


def test_cutting_through_a_block_costs_more_than_between_blocks():
    assert normalised_cut(BLOCKS, np.array([0, 0, 1, 1, 1, 1])) > 2 * normalised_cut(BLOCKS, SPLIT)


def test_a_trajectory_without_affinity_counts_as_cut_off():
    lonely = np.zeros((7, 7))
    lonely[:6, :6] = BLOCKS
    assert normalised_cut(lonely, np.append(SPLIT, 2)) == pytest.approx(normalised_cut(BLOCKS, SPLIT) + 1)


def test_the_cut_decides_between_groupings_of_equal_cost(rigid_clip):
    clip = rigid_clip((40,), noise=0)
    near = np.abs(clip.points[:, 0, None, 0] - clip.points[None, :, 0, 0]) < 150
    energy = Energy(clip.points, clip.visible, near.astype(np.float32), EnergyParams(spacing=0.3))
    by_side, by_chance = clip.points[:, 0, 0] > np.median(clip.points[:, 0, 0]), np.arange(40) % 2
    best = energy.minimum([by_chance, by_side.astype(int)])
    assert np.array_equal(best.labels, by_side) and best.cost < 1e-9


def test_the_cost_decides_between_groupings_of_equal_cut(rigid_clip):
    clip = rigid_clip((60, 40))
    everything = np.ones((100, 100), np.float32)
    energy = Energy(clip.points, clip.visible, everything, EnergyParams(spacing=0.3))
    wrong = np.roll(clip.labels, 20)
    assert np.array_equal(energy.minimum([wrong, clip.labels]).labels, clip.labels)


@pytest.mark.parametrize(("free_motions", "penalties"), [(0, (0.1, 0.2, 0.3)), (2, (0, 0, 0.1))])
def test_motions_beyond_those_that_are_free_are_penalised(free_motions, penalties, rigid_clip):
    clip = rigid_clip((40, 30), num_frames=8)
    kernel = np.ones((70, 70), np.float32)
    params = EnergyParams(motion_weight=0.1, free_motions=free_motions)
    groupings = [np.arange(70) % count for count in (1, 2, 3)]
    penalised, free = (
        Energy(clip.points, clip.visible, kernel, each)
        for each in (params, params.model_copy(update={"motion_weight": 0.0}))
    )
    for labels, penalty in zip(groupings, penalties, strict=True):
        assert penalised.minimum([labels]).energy - free.minimum([labels]).energy == pytest.approx(penalty)


@pytest.mark.parametrize(("num_tracks", "penalty"), [(25, 0.4), (100, 0.2)])
def test_the_fewer_trajectories_the_more_a_motion_has_to_gain(num_tracks, penalty, rigid_clip):
    clip, labels = rigid_clip((num_tracks,)), np.arange(num_tracks) % 3
    energies = []
    for chance_weight in (0, 2):
        params = EnergyParams(chance_weight=chance_weight, free_motions=2)
        energy = Energy(clip.points, clip.visible, np.ones((num_tracks,) * 2, np.float32), params)
        energies.append(energy.minimum([labels]).energy)
    assert energies[1] - energies[0] == pytest.approx(penalty)
