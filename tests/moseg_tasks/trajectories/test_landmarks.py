"""Laws of landmarks and of the assignment of other trajectories to their groups."""

import numpy as np
import pytest

from moseg.schemas.parameters import (
    EnergyParams,
    HypothesisParams,
    KernelParams,
    PieceParams,
    TrajectoryClusteringParams,
)
from moseg.tasks.metrics import clustering_error
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import (
    HypothesisResiduals,
    View,
    assign_motions,
    choose_landmarks,
    cluster_trajectories,
    draw_hypotheses,
    trajectory_kernels,
)

MODELS = ("affine", "homography", "fundamental")
WINDOW = KernelParams().window


def _clip(num_tracks, num_frames=4, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 500, (num_tracks, num_frames, 2)), rng.random((num_tracks, num_frames)) < 0.8


def _hypotheses(clip, num_draws=1):
    params = HypothesisParams(num_hypotheses=100, num_draws=num_draws)
    rng = np.random.default_rng(0)
    return [(draw_hypotheses(clip.points, clip.visible, POINT_MODELS[name], params, rng), name) for name in MODELS]


def _residuals(clip, found, tracks):
    return [
        HypothesisResiduals(drawn, clip.points[tracks], clip.visible[tracks], POINT_MODELS[name])
        for drawn, name in found
    ]


def test_all_trajectories_are_landmarks_up_to_the_limit():
    points, visible = _clip(50)
    assert np.array_equal(choose_landmarks(points, visible, 50), np.arange(50))
    assert np.array_equal(choose_landmarks(points, visible, 80), np.arange(50))


@pytest.mark.parametrize("count", [1, 7, 49])
def test_as_many_landmarks_are_chosen_as_asked_for(count):
    found = choose_landmarks(*_clip(50), count)
    assert len(np.unique(found)) == count and (np.diff(found) > 0).all() and found.max() < 50


def test_landmarks_lie_all_over_the_image_and_are_long():
    points, visible = _clip(4000)
    found = choose_landmarks(points, visible, 400)
    place = (points * visible[..., None]).sum(axis=1) / np.maximum(visible.sum(axis=1), 1)[:, None]
    for corner in np.ndindex(2, 2):
        inside = ((place >= 250) == corner).all(axis=1)
        assert np.mean(inside[found]) == pytest.approx(np.mean(inside), abs=0.03)
    assert visible[found].sum() / len(found) > 1.1 * visible.sum() / len(visible)


def test_equal_places_and_invisible_trajectories_are_no_obstacle():
    found = choose_landmarks(np.zeros((20, 3, 2)), np.zeros((20, 3), bool), 6)
    assert len(np.unique(found)) == 6


def test_others_join_the_group_of_their_motion(rigid_clip):
    clip = rigid_clip((150, 60, 40))
    landmarks = choose_landmarks(clip.points, clip.visible, 80)
    everything = _residuals(clip, _hypotheses(clip), slice(None))
    found = assign_motions(landmarks, clip.labels[landmarks], everything, WINDOW)
    assert np.array_equal(found[landmarks], clip.labels[landmarks])
    assert 100 * np.mean(found != clip.labels) <= 2


def test_a_trajectory_without_evidence_joins_the_largest_group(rigid_clip):
    clip = rigid_clip((60, 40))
    clip.visible[50:55] = False
    landmarks = np.setdiff1d(np.arange(100), np.arange(50, 60))
    found = assign_motions(
        landmarks, 1 - clip.labels[landmarks], _residuals(clip, _hypotheses(clip), slice(None)), WINDOW
    )
    assert (found[50:55] == 1).all()
    clip.visible[50:55] = True


def test_few_landmarks_give_nearly_the_groups_of_all_trajectories(rigid_clip):
    clip = rigid_clip((150, 60, 40))
    params = TrajectoryClusteringParams(pieces=PieceParams(counts=(5, 7)), energy=EnergyParams(spacing=0.3))
    hypotheses = _hypotheses(clip, num_draws=2)
    found = {}
    for limit in (80, 250):
        tracks = choose_landmarks(clip.points, clip.visible, limit)
        own = _residuals(clip, hypotheses, tracks)
        kernels = [trajectory_kernels(each, 2, KernelParams()) for each in own]
        assert {kernel.shape for kernel in kernels} == {(2, limit, limit)}
        views = [list(map(View, kernel, each.draws(2))) for kernel, each in zip(kernels, own, strict=True)]
        draws = list(zip(*views, strict=True))
        rng = np.random.default_rng(0)
        result = cluster_trajectories(draws, clip.points[tracks], clip.visible[tracks], 3, params, rng)
        found[limit] = assign_motions(tracks, result.motion, _residuals(clip, hypotheses, slice(None)), WINDOW)
        assert clustering_error(found[limit], clip.labels) <= 3
    assert clustering_error(found[80], found[250]) <= 3
