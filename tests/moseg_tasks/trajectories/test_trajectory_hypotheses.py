"""Laws of hypotheses and kernels of trajectories."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import HypothesisParams, KernelParams
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import draw_hypotheses, hypothesis_residuals, trajectory_kernel

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
    hypothesis_params = HypothesisParams(**{"num_hypotheses": 100, "num_draws": 1, **params})
    rng = np.random.default_rng(seed)
    found = draw_hypotheses(POINTS, VISIBLE, POINT_MODELS[model], hypothesis_params, rng)
    return found, hypothesis_residuals(found, POINTS, VISIBLE, POINT_MODELS[model])


@pytest.mark.parametrize("model", MODELS)
def test_only_what_all_frames_of_a_set_show_has_residuals(model):
    found, residuals = _residuals(model)
    num_frames = POINT_MODELS[model].num_frames
    assert found.frames.tolist() == [
        list(range(first, first + num_frames)) for first in range(NUM_FRAMES - num_frames + 1)
    ]
    for frames, distances in zip(found.frames, residuals, strict=True):
        seen = VISIBLE[:, frames].all(axis=1)
        assert np.isnan(distances[:, ~seen]).all() and (distances[:, seen] >= 0).all()


@pytest.mark.parametrize("model", ["affine", "homography"])
def test_a_sample_obeys_the_model_that_was_fitted_to_it(model):
    _, residuals = _residuals(model)
    size = POINT_MODELS[model].sample_size
    nearest = np.sort(np.nan_to_num(residuals, nan=np.inf), axis=2)[:, :, :size]
    assert np.median(nearest.max(axis=2)) < 0.05


def test_every_gap_has_its_pairs():
    found, _ = _residuals("affine", gaps=(1, 3))
    assert found.frames.tolist() == [[0, 1], [1, 2], [2, 3], [3, 4], [0, 3], [1, 4]]


def test_only_the_generator_changes_the_samples():
    assert np.array_equal(_residuals("affine", seed=1)[1], _residuals("affine", seed=1)[1], equal_nan=True)
    assert not np.array_equal(_residuals("affine", seed=1)[1], _residuals("affine", seed=2)[1], equal_nan=True)


@pytest.mark.parametrize("sparsity", [0.0, 10.0])
def test_a_kernel_is_symmetric_and_lies_in_the_unit_interval(sparsity):
    kernel = trajectory_kernel(_residuals("homography")[1], KernelParams(sparsity=sparsity))
    assert kernel.dtype == np.float32
    np.testing.assert_allclose(kernel, kernel.T, atol=1e-6)
    assert (kernel >= 0).all() and (kernel <= 1 + 1e-6).all()


def test_the_order_of_trajectories_does_not_matter_to_a_kernel():
    residuals = _residuals("affine")[1]
    order = np.random.default_rng(3).permutation(NUM_TRACKS)
    shuffled = trajectory_kernel(residuals[:, :, order], KernelParams(sparsity=0))
    same = trajectory_kernel(residuals, KernelParams(sparsity=0))[np.ix_(order, order)]
    assert np.abs(shuffled - same).max() < 0.02  # residuals equal in half precision may change places


def test_too_few_points_or_frames_are_bad_input():
    params = HypothesisParams()
    model = POINT_MODELS["fundamental"]
    with pytest.raises(InputError, match="too few trajectories for the fundamental model"):
        draw_hypotheses(POINTS[:7], VISIBLE[:7], model, params, np.random.default_rng(0))
    with pytest.raises(InputError, match="too few trajectories"):
        draw_hypotheses(POINTS[:, :1], VISIBLE[:, :1], model, params, np.random.default_rng(0))
