"""Laws of hypotheses and kernels of trajectories."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import HypothesisParams, KernelParams
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import HypothesisResiduals, draw_hypotheses, trajectory_kernels
from moseg.tasks.trajectories.hypothesis_residuals import NOT_SEEN, distance_codes, preferences

NUM_TRACKS, NUM_FRAMES = 60, 5
LABELS = np.repeat([0, 1], [35, 25])
MODELS = ("affine", "homography", "fundamental", "trifocal")


def _tracks(seed=0):
    """Two planes that each move by an affinity of their own; a tenth of the points is hidden."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(0, 500, (NUM_TRACKS, 2))
    steps = np.array([[[1.01, 0.01, 3], [-0.01, 1.01, 1]], [[0.99, -0.02, -4], [0.02, 0.99, 2]]])
    points = np.empty((NUM_TRACKS, NUM_FRAMES, 2))
    points[:, 0] = start
    for frame in range(1, NUM_FRAMES):
        before = np.concatenate([points[:, frame - 1], np.ones((NUM_TRACKS, 1))], axis=1)
        points[:, frame] = np.einsum("nij,nj->ni", steps[LABELS], before)
    return points + rng.normal(0, 0.01, points.shape), rng.random(points.shape[:2]) < 0.9


POINTS, VISIBLE = _tracks()


def _residuals(model, seed=0, **params):
    hypothesis_params = HypothesisParams(**{"num_hypotheses": 100, "num_draws": 1, "gaps": (1,), **params})
    rng = np.random.default_rng(seed)
    found = draw_hypotheses(POINTS, VISIBLE, POINT_MODELS[model], hypothesis_params, rng)
    return found, HypothesisResiduals(found, POINTS, VISIBLE, POINT_MODELS[model])


def _all(residuals):
    return residuals.of_tracks(np.arange(NUM_TRACKS))


@pytest.mark.parametrize("model", MODELS)
def test_only_what_all_frames_of_a_set_show_has_residuals(model):
    found, residuals = _residuals(model)
    num_frames = POINT_MODELS[model].num_frames
    assert found.frames.tolist() == [
        list(range(first, first + num_frames)) for first in range(NUM_FRAMES - num_frames + 1)
    ]
    for index, (frames, codes) in enumerate(zip(found.frames, _all(residuals), strict=True)):
        seen = VISIBLE[:, frames].all(axis=1)
        assert np.array_equal(codes == NOT_SEEN, np.repeat(~seen[:, None], 100, axis=1))
        assert np.array_equal(residuals.of_set(index).codes, codes[seen])


@pytest.mark.parametrize("model", ["affine", "homography"])
def test_a_sample_obeys_the_model_that_was_fitted_to_it(model):
    _, residuals = _residuals(model)
    size = POINT_MODELS[model].sample_size
    nearest = np.sort(_all(residuals), axis=1)[:, :size]
    assert np.median(nearest.max(axis=1)) < distance_codes(np.array([0.05**2], np.float32))


def test_codes_have_the_order_of_distances():
    distances = np.sort(10 ** np.random.default_rng(0).uniform(-4, 4, 1000)).astype(np.float32)
    codes = distance_codes(distances**2)
    assert codes.dtype == np.uint16 and (np.diff(codes.astype(int)) >= 0).all()
    apart = distances[1:] > 1.001 * distances[:-1]
    assert (np.diff(codes.astype(int))[apart] > 0).all()
    extremes = distance_codes(np.array([0, 1e-30, 1, 1e30, np.inf, np.nan], np.float32))
    assert extremes[0] == extremes[1] == 0 < extremes[2] < extremes[3] == extremes[4] == extremes[5] < NOT_SEEN


def test_equally_near_hypotheses_are_all_preferred():
    codes = np.array([[5, 1, 3, 3, 9]], np.uint16)
    assert preferences(codes, 2).tolist() == [[False, True, True, True, False]]
    assert preferences(codes, 9).all()


def test_draws_share_what_they_compute():
    residuals = _residuals("affine")[1]
    first, second = residuals.draws(2)
    tracks = np.array([3, 50, 7])
    both = np.concatenate([first.of_tracks(tracks), second.of_tracks(tracks)], axis=2)
    assert np.array_equal(both, _all(residuals)[:, tracks])
    assert first.num_hypotheses == second.num_hypotheses == 50


def test_known_codes_are_not_computed_again():
    found, residuals = _residuals("affine")
    codes = residuals.all_codes()
    model = POINT_MODELS["affine"]
    again = HypothesisResiduals(found, np.full_like(POINTS, np.nan), VISIBLE, model, codes).draws(2)[1]
    drawn = residuals.draws(2)[1]
    tracks = np.array([3, 50, 7])
    assert np.array_equal(again.of_tracks(tracks), drawn.of_tracks(tracks))
    fresh = HypothesisResiduals(found, POINTS, VISIBLE, model).draws(2)[1].of_set(1)
    for one, other in zip(again.of_set(1), fresh, strict=True):
        assert np.array_equal(one, other)


def test_every_gap_has_its_pairs():
    found, _ = _residuals("affine", gaps=(1, 3))
    assert found.frames.tolist() == [[0, 1], [1, 2], [2, 3], [3, 4], [0, 3], [1, 4]]


def test_sets_of_a_long_clip_are_spaced_out():
    visible = np.ones((20, 101), bool)
    points = np.random.default_rng(0).uniform(0, 500, (20, 101, 2))
    params = HypothesisParams(num_hypotheses=5, num_draws=1, gaps=(1,), max_sets=20)
    found = draw_hypotheses(points, visible, POINT_MODELS["affine"], params, np.random.default_rng(0))
    assert found.frames[:, 0].tolist() == list(range(0, 100, 5)) and (np.diff(found.frames) == 1).all()
    # Short trajectories keep all their sets.
    visible = np.arange(101) // 20 == np.arange(20)[:, None] // 4
    found = draw_hypotheses(points, visible, POINT_MODELS["affine"], params, np.random.default_rng(0))
    assert len(found.frames) == 5 * 19


def test_gaps_are_reduced_in_clips_that_are_too_short():
    params, model = HypothesisParams(num_hypotheses=5, num_draws=1, gaps=(3,)), POINT_MODELS["affine"]
    for num_frames, gap in ((5, 3), (3, 2), (2, 1)):
        drawn = draw_hypotheses(
            POINTS[:, :num_frames], VISIBLE[:, :num_frames], model, params, np.random.default_rng(0)
        )
        assert set(np.diff(drawn.frames).ravel()) == {gap}
    # So they are if trajectories are too short.
    visible = np.arange(NUM_FRAMES) // 2 == np.arange(NUM_TRACKS)[:, None] % 3
    assert draw_hypotheses(POINTS, visible, model, params, np.random.default_rng(0)).frames.tolist() == [[0, 1], [2, 3]]


def test_only_the_generator_changes_the_samples():
    assert np.array_equal(_all(_residuals("affine", seed=1)[1]), _all(_residuals("affine", seed=1)[1]))
    assert not np.array_equal(_all(_residuals("affine", seed=1)[1]), _all(_residuals("affine", seed=2)[1]))


@pytest.mark.parametrize("sparsity", [0.0, 10.0])
def test_a_kernel_is_symmetric_and_lies_in_the_unit_interval(sparsity):
    (kernel,) = trajectory_kernels(_residuals("homography")[1], 1, KernelParams(sparsity=sparsity))
    assert kernel.dtype == np.float32
    np.testing.assert_allclose(kernel, kernel.T, atol=1e-6)
    assert (kernel >= 0).all() and (kernel <= 1 + 1e-6).all()


def test_the_order_of_trajectories_does_not_matter_to_a_kernel():
    found, residuals = _residuals("affine")
    order = np.random.default_rng(3).permutation(NUM_TRACKS)
    shuffled = HypothesisResiduals(found, POINTS[order], VISIBLE[order], POINT_MODELS["affine"])
    (kernel,) = trajectory_kernels(residuals, 1, KernelParams(sparsity=0))
    # Rounding of the distances may change the order of two of them.
    assert (
        np.abs(trajectory_kernels(shuffled, 1, KernelParams(sparsity=0))[0] - kernel[np.ix_(order, order)]).max() < 0.02
    )


def test_a_kernel_is_the_same_in_blocks_of_sets(monkeypatch):
    residuals = _residuals("affine")[1]
    whole = trajectory_kernels(residuals, 2, KernelParams())
    monkeypatch.setattr("moseg.tasks.trajectories.kernel._BLOCK_BYTES", 1)
    np.testing.assert_allclose(trajectory_kernels(residuals, 2, KernelParams()), whole, atol=1e-6)


def test_more_trajectories_than_are_cached_have_the_same_residuals(monkeypatch):
    whole = _all(_residuals("affine")[1])
    monkeypatch.setattr("moseg.tasks.trajectories.hypothesis_residuals._CACHED_BYTES", 0)
    tracks = np.array([5, 2, 41])
    some = _residuals("affine")[1].of_tracks(tracks)
    # Another set of points has other local coordinates, and so other roundings.
    assert np.mean(some == whole[:, tracks]) > 0.9
    assert np.array_equal(some == NOT_SEEN, whole[:, tracks] == NOT_SEEN)


def test_too_few_points_or_frames_are_bad_input():
    params = HypothesisParams()
    model = POINT_MODELS["fundamental"]
    with pytest.raises(InputError, match="too few trajectories for the fundamental model"):
        draw_hypotheses(POINTS[:7], VISIBLE[:7], model, params, np.random.default_rng(0))
    with pytest.raises(InputError, match="too few trajectories"):
        draw_hypotheses(POINTS[:, :1], VISIBLE[:, :1], model, params, np.random.default_rng(0))
