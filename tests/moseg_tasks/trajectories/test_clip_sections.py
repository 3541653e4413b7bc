"""Laws of clips much longer than their trajectories."""

import numpy as np
import pytest

from moseg.schemas.parameters import (
    ClipSectionParams,
    HypothesisParams,
    KernelParams,
    TrajectoryClusteringParams,
)
from moseg.tasks.metrics import clustering_error
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import (
    HypothesisResiduals,
    ModelKernels,
    choose_landmarks,
    draw_hypotheses,
    group_clip,
    group_trajectories,
    trajectory_kernels,
)

KERNEL = KernelParams()
SECTIONS = ClipSectionParams()
PARAMS = TrajectoryClusteringParams()
LENGTH = 16
"""Frames in which a trajectory is visible."""


def _long_clip(num_frames=96, num_tracks=420, seed=0):
    """Return points, visibility and labels of a still scene and a mover that sways to and fro."""
    rng = np.random.default_rng(seed)
    labels = (np.arange(num_tracks) % 3 == 0).astype(int)
    body = rng.uniform(-1, 1, (num_tracks, 3)) * np.where(labels[:, None], [1.5, 1.2, 1.5], [9, 4, 6])
    points = np.empty((num_tracks, num_frames, 2))
    for frame in range(num_frames):
        sway, drift = np.sin(0.3 * frame), np.sin(0.17 * frame)
        angle = 0.3 * sway * labels
        x = body[:, 0] * np.cos(angle) + body[:, 2] * np.sin(angle)
        z = body[:, 2] * np.cos(angle) - body[:, 0] * np.sin(angle)
        camera = np.stack([x - 4 * labels + 1.5 * sway * labels, body[:, 1], z + 16 - 6 * labels], axis=1)
        camera = camera - np.array([1.2 * drift, 0.1 * sway, 1.5 * np.cos(0.17 * frame)])
        points[:, frame] = 400 * camera[:, :2] / camera[:, 2:] + [300, 200]
    points += rng.normal(0, 0.05, points.shape)
    first = rng.integers(num_frames - LENGTH + 1, size=num_tracks)[:, None]
    frames = np.arange(num_frames)
    return points, (frames >= first) & (frames < first + LENGTH), labels


def _views(points, visible, max_tracks):
    drawing, rng, views = HypothesisParams(num_hypotheses=100), np.random.default_rng(0), []
    tracks = choose_landmarks(points, visible, max_tracks)
    for name in ("affine", "homography", "fundamental"):
        model = POINT_MODELS[name]
        drawn = draw_hypotheses(points, visible, model, drawing, rng)
        residuals = HypothesisResiduals(drawn, points[tracks], visible[tracks], model)
        views.append(ModelKernels(model, drawn, trajectory_kernels(residuals, drawing.num_draws, KERNEL)))
    return views


def _group(clip, num_motions, max_tracks=1000):
    points, visible, _ = clip
    views, rng = _views(points, visible, max_tracks), np.random.default_rng(0)
    no_stray = np.zeros(len(points), bool)
    return group_clip(points, visible, no_stray, views, num_motions, PARAMS, SECTIONS, KERNEL.window, rng)


@pytest.mark.parametrize("num_motions", [2, None])
def test_groups_are_linked_over_sections_without_a_common_trajectory(num_motions):
    clip = _long_clip()
    found = _group(clip, num_motions)
    assert clustering_error(found.motion, clip[2]) < 2
    assert found.clustering.num_motions == 2
    assert found.clustering.motion.shape == (len(clip[0]),)
    assert np.isfinite(found.clustering.costs[1])


def test_trajectories_that_are_no_landmarks_join_the_linked_groups():
    clip = _long_clip()
    found = _group(clip, 2, max_tracks=340)
    assert found.clustering.motion.shape == (340,)
    assert clustering_error(found.motion, clip[2]) < 4


def test_a_short_clip_is_one_section():
    points, visible, labels = _long_clip(num_frames=3 * LENGTH)
    views = _views(points, visible, 1000)
    expected = group_trajectories(points, visible, views, 2, PARAMS, KERNEL.window, np.random.default_rng(0))
    assert np.array_equal(_group((points, visible, labels), 2).motion, expected.motion)


def test_a_trajectory_of_too_few_frames_for_any_section_joins_a_group():
    points, visible, labels = _long_clip()
    visible[0] = False
    visible[0, 30:34] = True
    found = _group((points, visible, labels), 2)
    assert found.motion.shape == (len(points),)
    assert clustering_error(found.motion, labels) < 2


def test_strays_join_the_groups_of_the_others():
    points, visible, labels = _long_clip(num_frames=3 * LENGTH)
    is_stray = np.arange(len(points)) < 5
    views, rng = _views(points, visible, 1000), np.random.default_rng(0)
    found = group_clip(points, visible, is_stray, views, 2, PARAMS, SECTIONS, KERNEL.window, rng)
    assert found.num_outliers >= 5
    assert len(found.clustering.motion) <= len(points) - 5
    assert clustering_error(found.motion, labels) < 2


@pytest.mark.parametrize("method", ["energy", "sum"])
def test_groups_do_not_depend_on_known_codes(method):
    points, visible, _ = _long_clip(LENGTH, 90)
    rng = np.random.default_rng(1)
    points[::15] = rng.uniform(0, 600, (6, 1, 2)) + np.cumsum(rng.normal(0, 4, (6, LENGTH, 2)), axis=1)
    is_stray = np.arange(90) == 15
    params = PARAMS.model_copy(update={"method": method})
    views = _views(points, visible, 80)
    landmarks = choose_landmarks(points, visible, 80)
    found = []
    for known in (views, [view.with_codes(points[landmarks], visible[landmarks]) for view in views]):
        rest = None, params, SECTIONS, KERNEL.window, np.random.default_rng(0)
        found.append(group_clip(points, visible, is_stray, known, *rest))
    assert found[0].num_outliers == found[1].num_outliers and (method == "sum" or found[0].num_outliers > 1)
    for name in ("motion", "embedding", "costs", "codes"):
        assert np.array_equal(*(getattr(each.clustering, name) for each in found), equal_nan=True)
    assert np.array_equal(found[0].motion, found[1].motion)
