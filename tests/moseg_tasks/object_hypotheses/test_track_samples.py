"""Two-view models of samples of the whole frame's tracks."""

import numpy as np
import pytest

from moseg.schemas.parameters import ObjectHypothesisParams
from moseg.tasks.object_hypotheses import track_sample_residuals

PARAMS = ObjectHypothesisParams(num_hypotheses=150)
FUNDAMENTAL, HOMOGRAPHY = 0, 1


@pytest.fixture(scope="module")
def tracks():
    """60 points of a rigid background and 15 of each of a static object and a mover, projected into two views."""
    rng = np.random.default_rng(1)
    nodes = np.repeat([0, 1, 2], [60, 15, 15])
    X = np.column_stack([rng.uniform(-3, 3, 90), rng.uniform(-2, 2, 90), rng.uniform(4, 12, 90)])
    moved = X + np.where((nodes == 2)[:, None], [0.4, 0.5, -0.3], [0.2, 0.02, -0.6])
    points0, points1 = (400 * P[:, :2] / P[:, 2:] + [320, 240] for P in (X, moved))
    return points0, points1, nodes


def residuals(tracks, seed=0, **changes):
    values = {"num_nodes": 3, "min_points": 8} | changes
    points0, points1, nodes = tracks
    rng = np.random.default_rng(seed)
    return track_sample_residuals(points0, points1, nodes, values["num_nodes"], values["min_points"], PARAMS, rng)


def test_what_explains_the_background_explains_what_rests_and_not_the_mover(tracks):
    found = residuals(tracks)[FUNDAMENTAL]
    right = found[:, 0] < 1e-3
    assert right.sum() >= 3
    assert found[right, 1].max() < 1e-2
    assert found[right, 2].min() > 1


def test_homographies_see_depth_where_fundamental_matrices_do_not(tracks):
    found = residuals(tracks)
    assert found[FUNDAMENTAL, :, 0].min() < 1e-3
    assert found[HOMOGRAPHY, :, 0].min() > 0.1


def test_a_mistracked_point_does_not_decide(tracks):
    points0, points1, nodes = tracks
    lost = points1.copy()
    lost[np.flatnonzero(nodes == 1)[:3]] += [40, -90]
    found = residuals((points0, lost, nodes))[FUNDAMENTAL]
    right = found[:, 0] < 1e-3
    assert right.any()
    assert found[right, 1].max() < 1e-2


def test_nodes_of_few_tracks_are_absent(tracks):
    found = residuals(tracks, num_nodes=4, min_points=16)
    assert np.isfinite(found[..., 0]).all()
    assert np.isnan(found[..., 1:]).all()


def test_with_too_few_tracks_for_a_sample_nothing_is_known(tracks):
    points0, points1, nodes = (part[:6] for part in tracks)
    found = residuals((points0, points1, nodes), min_points=2)
    assert np.isnan(found[FUNDAMENTAL]).all()
    assert np.isfinite(found[HOMOGRAPHY, :, 0]).all()
    none = residuals((points0[:0], points1[:0], nodes[:0]))
    assert np.isnan(none).all()


def test_a_seed_fixes_the_draw(tracks):
    np.testing.assert_array_equal(residuals(tracks), residuals(tracks))
    assert not np.array_equal(residuals(tracks), residuals(tracks, seed=1))


def test_degenerate_samples_explain_nothing_but_exclude_no_object():
    """All tracks but a few lie in two places: most samples determine no model."""
    rng = np.random.default_rng(2)
    points0 = rng.uniform(0, 640, (40, 2))
    points0[:15], points0[15:30] = [100.0, 200.0], [1e6, -1e6]
    points1 = points0 + rng.normal(0, 1e-3, points0.shape)
    found = residuals((points0, points1, np.repeat([0, 1], 20)), num_nodes=2)
    assert not np.isnan(found).any()
    assert np.isfinite(found).any()
