"""Laws of the coding length of groupings, and of the windows and depths that it reads."""

import numpy as np
import pytest

from moseg.schemas.parameters import CodingParams, EnergyParams
from moseg.tasks.trajectories.coding_length import CodingLength
from moseg.tasks.trajectories.epipolar_cost import EpipolarCost
from moseg.tasks.trajectories.projective_depths import projective_depths
from moseg.tasks.trajectories.track_windows import track_windows

PARAMS = CodingParams()


def two_turning_bodies(noise=0.1, seed=0):
    """Two bodies that turn about vertical axes before a still affine camera, each with its own angles over time.

    All displacements are horizontal, so that one fundamental matrix explains any two frames; over all frames the
    trajectories of each body span three dimensions of their own.
    """
    rng = np.random.default_rng(seed)
    labels = np.repeat([0, 1], 40)
    x, y, z = rng.uniform(-100, 100, (3, 80, 1))
    time = np.arange(20)
    angles = np.stack([0.08 * time, 0.8 * np.sin(0.6 * time)])[labels]
    points = np.stack([x * np.cos(angles) + z * np.sin(angles), np.broadcast_to(y, angles.shape)], axis=2)
    return points + rng.normal(0, noise, points.shape), np.ones((80, 20), bool), labels


def test_many_frames_separate_what_one_fundamental_matrix_explains_in_any_two():
    points, visible, labels = two_turning_bodies()
    one, mixed = np.zeros(80, int), np.roll(labels, 20)
    costs = EpipolarCost(points, visible, EnergyParams(spacing=0.3)).of_labelings([one, labels])
    assert costs[0] < 0.1 and costs[0] - costs[1] < 0.05
    true, wrong = CodingLength(points, visible, PARAMS).of_labelings([labels, mixed])
    assert true < 1 and true < wrong - 0.1


def test_one_motion_has_length_one_and_parts_of_it_are_longer(rigid_clip):
    clip = rigid_clip((80,), num_frames=12, hidden=0)
    halves = (clip.points[:, 0, 0] > np.median(clip.points[:, 0, 0])).astype(int)
    one, split = CodingLength(clip.points, clip.visible, PARAMS).of_labelings([np.zeros(80, int), halves])
    assert one == pytest.approx(1) and split > 1


def test_parts_of_a_short_list_of_long_trajectories_pay_for_more_than_their_labels():
    points, visible, labels = two_turning_bodies()
    points, visible = np.repeat(points[labels == 0], 10, axis=1), np.repeat(visible[labels == 0], 10, axis=1)
    one, split = CodingLength(points, visible, PARAMS).of_labelings([np.zeros(40, int), np.arange(40) % 2])
    # The labels alone are 0.01 of the bits.
    assert one == pytest.approx(1) and split > 1.015


def test_depths_keep_a_scene_of_strong_perspective_together(rigid_clip):
    clip = rigid_clip((200,), num_frames=20, hidden=0)
    near = (clip.points[:, -1, 1] > np.median(clip.points[:, -1, 1])).astype(int)
    halves = [
        CodingLength(clip.points, clip.visible, PARAMS.model_copy(update={"num_rounds": rounds})) for rounds in (0, 10)
    ]
    affine, projective = (float(each.of_labelings([near])[0]) for each in halves)
    assert projective > affine and projective > 1


def test_depths_restore_four_dimensions(rigid_clip):
    clip = rigid_clip((60,), num_frames=8, hidden=0, noise=0)
    centred = clip.points - clip.points.mean(axis=(0, 1))
    homogeneous = np.concatenate([centred / 100, np.ones((60, 8, 1))], axis=2)

    def beyond_four(depths):
        values = np.linalg.svd((homogeneous * depths[..., None]).reshape(60, -1), compute_uv=False)
        return values[4] / values[3]

    before, after = beyond_four(np.ones((60, 8))), beyond_four(projective_depths(centred, 40))
    assert after < before / 10


def test_labels_may_be_renumbered(rigid_clip):
    clip = rigid_clip((40, 30), num_frames=12)
    length = CodingLength(clip.points, clip.visible, PARAMS)
    assert np.ptp(length.of_labelings([clip.labels, 1 - clip.labels, 5 * clip.labels])) == pytest.approx(0)


def test_hidden_points_are_interpolated_and_never_read(rigid_clip):
    clip = rigid_clip((60, 40), num_frames=16, hidden=0)
    complete = CodingLength(clip.points, clip.visible, PARAMS).of_labelings([clip.labels])[0]
    hidden = np.random.default_rng(1).random(clip.visible.shape) < 0.3
    spoilt = np.where(hidden[..., None], 1e5, clip.points)
    windows = track_windows(spoilt, ~hidden, PARAMS)
    assert max(len(window.tracks) for window in windows) > 30
    assert max(np.abs(window.points).max() for window in windows) < 1e4
    assert CodingLength(spoilt, ~hidden, PARAMS).of_labelings([clip.labels])[0] == pytest.approx(complete, abs=0.1)


def test_the_growth_of_a_group_predicts_what_a_move_changes():
    points, visible, labels = two_turning_bodies(noise=1.0)
    length = CodingLength(points, visible, PARAMS)
    growth = length.of_trajectories(labels)
    rows = np.flatnonzero(labels == 0)[:10]
    assert (growth[rows, 0] < growth[rows, 1]).all()
    moved = labels.copy()
    moved[rows[0]] = 1
    change = np.diff(length.of_labelings([labels, moved]))[0]
    assert change > 0 and growth[rows[0], 1] - growth[rows[0], 0] > 0


@pytest.mark.parametrize(("num_tracks", "num_frames"), [(80, 2), (80, 4), (5, 20), (0, 20)])
def test_too_few_frames_or_trajectories_leave_every_grouping_equal(num_tracks, num_frames):
    points, visible, labels = two_turning_bodies()
    length = CodingLength(points[:num_tracks, :num_frames], visible[:num_tracks, :num_frames], PARAMS)
    assert (length.of_labelings([labels[:num_tracks]] * 2) == 1).all()
    assert not length.of_trajectories(labels[:num_tracks]).any() if num_tracks else True


def test_windows_overlap_and_end_with_the_clip():
    visible = np.zeros((60, 40), bool)
    for track, start in enumerate(np.tile(np.arange(30), 2)):
        visible[track, start : start + 11] = True
    points = np.broadcast_to(np.arange(40.0)[None, :, None], (60, 40, 2))
    windows = track_windows(points, visible, PARAMS.model_copy(update={"min_tracks": 1}))
    assert all(window.length == int(11 * PARAMS.window_share) for window in windows) and len(windows) > 4
    assert all((np.diff(window.points[..., 0], axis=1) > 0).all() for window in windows)


def test_standing_points_have_no_length():
    points = np.broadcast_to(np.zeros((20, 1, 2)), (20, 10, 2))
    length = CodingLength(points, np.ones((20, 10), bool), PARAMS)
    assert (length.of_labelings([np.zeros(20, int), np.arange(20) % 2]) == 1).all()
