"""Laws of trajectories that follow no motion."""

import numpy as np
import pytest

from moseg.schemas.parameters import (
    CodingParams,
    HypothesisParams,
    KernelParams,
    OutlierParams,
    TrajectoryClusteringParams,
)
from moseg.tasks.metrics import clustering_error
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import ModelKernels, draw_hypotheses, group_trajectories, trajectory_kernels
from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals
from moseg.tasks.trajectories.outliers import find_outliers, join_outliers
from moseg.tasks.trajectories.subspace_distances import subspace_distances

PARAMS = OutlierParams()
GROUPS = np.repeat([0, 1], [40, 15])


def _kernel(num_outliers=0, seed=0):
    rng = np.random.default_rng(seed)
    groups = np.concatenate([GROUPS, 2 + np.arange(num_outliers)])
    kernel = np.where(groups[:, None] == groups, 0.6, 0.1) * rng.uniform(0.8, 1.2, (len(groups),) * 2)
    kernel = (kernel + kernel.T) / 2
    np.fill_diagonal(kernel, 1)
    return kernel


def _find(kernel, distances=None):
    return find_outliers(kernel, np.ones(len(kernel)) if distances is None else distances, PARAMS)


def _with_random_tracks(clip, num_outliers, seed=0):
    rng = np.random.default_rng(seed)
    num_frames = clip.points.shape[1]
    walks = np.cumsum(rng.normal(0, 4, (num_outliers, num_frames, 2)), axis=1)
    points = np.concatenate([clip.points, rng.uniform(0, 500, (num_outliers, 1, 2)) + walks])
    return points, np.concatenate([clip.visible, np.ones((num_outliers, num_frames), bool)])


def _group(points, visible, num_motions, params):
    rng, drawn, views = np.random.default_rng(0), HypothesisParams(num_hypotheses=100), []
    for name in ("affine", "homography", "fundamental"):
        model = POINT_MODELS[name]
        found = draw_hypotheses(points, visible, model, drawn, rng)
        kernels = trajectory_kernels(HypothesisResiduals(found, points, visible, model), 2, KernelParams())
        views.append(ModelKernels(model, found, kernels))
    return group_trajectories(points, visible, views, num_motions, params, KernelParams().window, rng)


@pytest.mark.parametrize("num_outliers", [0, 5, 50])
def test_outliers_are_found_and_small_groups_are_kept(num_outliers):
    found = _find(_kernel(num_outliers))
    assert not found[: len(GROUPS)].any() and found[len(GROUPS) :].all()


def test_a_scale_of_affinities_changes_nothing():
    assert np.array_equal(_find(0.01 * _kernel(5)), _find(_kernel(5)))


def test_trajectories_far_from_all_hypotheses_are_outliers_although_they_agree():
    distances = np.where(GROUPS == 1, 60.0, 1.0)
    kernel = _kernel() * np.where(GROUPS[:, None] & GROUPS, 0.9, 1)
    assert np.array_equal(_find(kernel, distances), GROUPS == 1)
    assert not _find(kernel, np.where(GROUPS == 1, 10.0, 1.0)).any()
    assert not _find(kernel, np.where(GROUPS == 1, np.nan, 1.0)).any()


def test_few_trajectories_and_no_affinities_give_no_outliers():
    assert not _find(_kernel()[:6, :6]).any()
    assert not _find(np.zeros((30, 30))).any()


def test_an_outlier_joins_the_group_that_is_most_like_it():
    kernel, is_outlier = _kernel(), np.zeros(len(GROUPS), bool)
    is_outlier[[2, 50]] = True
    unknown = np.full((len(GROUPS), 2), np.nan)
    joined = join_outliers(kernel, is_outlier, GROUPS[~is_outlier].astype(np.uint16), unknown, PARAMS)
    assert np.array_equal(joined, GROUPS) and joined.dtype == np.uint16
    assert np.array_equal(join_outliers(kernel, np.zeros(len(GROUPS), bool), GROUPS, unknown, PARAMS), GROUPS)


def test_an_outlier_without_affinities_joins_the_group_whose_motion_it_follows(rigid_clip):
    clip = rigid_clip((60, 40), num_frames=12, hidden=0)
    is_outlier = np.zeros(100, bool)
    is_outlier[[5, 90]] = True
    points = clip.points.copy()
    points[is_outlier, 8] += 10
    labels = np.where(is_outlier, -1, clip.labels)
    distances = subspace_distances(points, clip.visible, labels, CodingParams())
    kernel = np.zeros((100, 100))
    assert np.array_equal(
        join_outliers(kernel + 0.1, is_outlier, clip.labels[~is_outlier], distances, PARAMS), clip.labels
    )
    # A large affinity to another group outweighs a small difference of distances.
    kernel[is_outlier[:, None] & (clip.labels == 0)] = 1.0
    joined = join_outliers(kernel, is_outlier, clip.labels[~is_outlier], np.where(distances > 1.5, 1.5, 1), PARAMS)
    assert not joined[is_outlier].any()


def test_the_distance_from_a_subspace_is_not_known_without_windows_or_members(rigid_clip):
    clip = rigid_clip((60, 40), num_frames=12, hidden=0)
    assert np.isnan(subspace_distances(clip.points[:, :4], clip.visible[:, :4], clip.labels, CodingParams())).all()
    few = np.where((clip.labels == 1) & (np.arange(100) > 65), -1, clip.labels)
    distances = subspace_distances(clip.points, clip.visible, few, CodingParams())
    assert np.isfinite(distances[:, 0]).all() and np.isnan(distances[:, 1]).all()


def test_random_tracks_take_no_motion_of_their_own(rigid_clip):
    clip = rigid_clip((80, 40, 30))
    points, visible = _with_random_tracks(clip, 60)
    found = _group(points, visible, 3, TrajectoryClusteringParams())
    assert clustering_error(found.motion[:150], clip.labels) <= 5
    assert found.num_outliers >= 20 and found.motion.max() == 2


def test_published_methods_cluster_outliers_too(rigid_clip):
    points, visible = _with_random_tracks(rigid_clip((40, 20)), 20)
    assert _group(points, visible, 2, TrajectoryClusteringParams(method="sum")).num_outliers == 0


def test_two_frames_are_enough_for_exact_motions(rigid_clip):
    clip = rigid_clip((80, 40, 30), num_frames=2, hidden=0)
    found = _group(clip.points, clip.visible, 3, TrajectoryClusteringParams())
    assert clustering_error(found.motion, clip.labels) <= 5


def test_trajectories_that_never_overlap_in_time_are_grouped(rigid_clip):
    clip = rigid_clip((80, 40), num_frames=12, hidden=0)
    clip.visible[::2, 6:] = clip.visible[1::2, :6] = False
    for count in (2, None):
        found = _group(clip.points, clip.visible, count, TrajectoryClusteringParams())
        assert found.motion.shape == (120,) and 1 <= found.clustering.num_motions <= 6


def test_points_that_stand_still_are_one_motion():
    points = np.repeat(np.random.default_rng(0).uniform(0, 500, (60, 1, 2)), 8, axis=1)
    assert not _group(points, np.ones((60, 8), bool), None, TrajectoryClusteringParams()).motion.any()


def test_a_group_of_two_does_not_take_an_outlier_by_its_best_neighbours_alone():
    groups = np.array([0] * 20 + [1] * 2)
    kernel = np.pad(np.where(groups[:, None] == groups, 0.6, 0.1), (0, 1), constant_values=0.1)
    kernel[-1, :20], kernel[-1, 20:22] = 0.30, 0.35
    unknown = np.full((23, 2), np.nan)
    assert join_outliers(kernel, np.arange(23) == 22, groups, unknown, OutlierParams())[-1] == 0
