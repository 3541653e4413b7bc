"""Epipolar geometries of motions, and the distances of tracks to them."""

import numpy as np
import pytest

from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.clustering.affine_epipolar import affine_epipolar_distances
from moseg.tasks.clustering.description_length import description_length
from moseg.tasks.clustering.epipolar_distances import EpipolarDistances, MotionDistances
from moseg.tasks.clustering.motion_tracks import MotionTracks, frame_pairs
from moseg.tasks.synthetic.rigid_tracks import rigid_tracks

PARAMS = MotionCountParams()
AFFINE = {"threshold": 0.5, "num_samples": 100}


def affine_views(num: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A rigid cloud under two affine cameras, px."""
    rng = np.random.default_rng(seed)
    cloud = rng.normal(size=(num, 3)) * 40
    return cloud @ rng.normal(size=(3, 2)) + 300, cloud @ rng.normal(size=(3, 2)) + 310


def distances_of(num_objects, labels, noise=0.0, seed=0) -> MotionDistances:
    tracks = rigid_tracks(num_objects, 6, 20, noise, np.random.default_rng(seed))
    section = MotionTracks(tracks.points, tracks.visible, tracks.owner)
    fits = EpipolarDistances((section,), len(tracks.motion), PARAMS, np.random.default_rng(1))
    return fits.of(tracks.motion if labels is None else labels)


@pytest.mark.parametrize("seed", range(4))
def test_exact_affine_views_obey_their_geometry(seed):
    points = affine_views(12, seed)
    assert affine_epipolar_distances(*points, rng=np.random.default_rng(0), **AFFINE).max() < 1e-9


def test_outliers_do_not_bend_the_affine_geometry():
    points0, points1 = affine_views(20)
    rng = np.random.default_rng(0)
    points1[:6] += rng.uniform(20, 60, (6, 2))
    distance = affine_epipolar_distances(points0, points1, rng=rng, **AFFINE)
    assert distance[6:].max() < 0.01 and np.sort(distance[:6])[1] > 1.0


def test_four_points_determine_no_affine_geometry():
    assert affine_epipolar_distances(*affine_views(4), rng=np.random.default_rng(0), **AFFINE) is None


def test_exact_tracks_have_no_distance_to_their_motion():
    found = distances_of([4, 2], None)
    assert found.full.max() < 1e-6
    assert found.fit.max() + 1 == 2 * 3


def test_two_motions_as_one_leave_what_they_do_not_share():
    found = distances_of([4, 2], np.zeros(6, int))
    assert np.quantile(found.full, 0.95) > 0.5
    assert found.fit.max() + 1 == 3


def test_a_motion_of_too_few_points_has_no_fit():
    points0 = np.random.default_rng(0).uniform(0, 300, (11, 2))
    points = np.stack([points0, points0 + 1, points0 + 2], axis=1)
    tracks = MotionTracks(points, np.ones((11, 3), bool), np.array([0] * 7 + [1] * 4))
    found = EpipolarDistances((tracks,), 2, PARAMS, np.random.default_rng(0)).of(np.array([0, 1]))
    assert np.isinf(found.full).all()
    assert np.isinf(found.affine).sum() == 4


def test_fits_do_not_depend_on_what_was_fitted_before():
    tracks = rigid_tracks([3, 2], 6, 20, 0.1, np.random.default_rng(0))
    section = MotionTracks(tracks.points, tracks.visible, tracks.owner)
    first, second = (EpipolarDistances((section,), 5, PARAMS, np.random.default_rng(1)) for _ in range(2))
    second.of(np.arange(5))
    for one, other in zip(first.of(tracks.motion), second.of(tracks.motion), strict=True):
        assert np.array_equal(one, other)


def test_frame_pairs_of_a_stretch_shorter_than_the_gap():
    assert frame_pairs(5, 3) == [(0, 3), (1, 4)]
    assert frame_pairs(3, 3) == [(0, 2)]
    assert frame_pairs(1, 3) == frame_pairs(0, 3) == []


def test_the_description_length_of_no_tracks_is_zero():
    empty = MotionDistances(np.empty(0, int), np.empty(0), np.empty(0), np.empty(0, bool))
    assert description_length(empty, PARAMS) == 0.0


def test_small_distances_take_fewer_nats_than_large_ones():
    rng = np.random.default_rng(0)
    fit = np.repeat(np.arange(4), 50)
    lengths = []
    for noise in (0.1, 0.3, 0.9):
        distance = np.abs(rng.normal(scale=noise, size=200))
        lengths.append(
            description_length(MotionDistances(fit, distance, np.full(200, np.inf), np.zeros(200, bool)), PARAMS)
        )
    assert lengths == sorted(lengths)
    nats_of_outliers = 200 * np.log(2 * PARAMS.outlier_range / 0.01)
    assert lengths[-1] < nats_of_outliers


def test_the_cheaper_of_two_equal_models_is_taken():
    distance = np.abs(np.random.default_rng(0).normal(scale=0.1, size=100))
    fit, missing, flat = np.zeros(100, int), np.full(100, np.inf), np.zeros(100, bool)
    both = description_length(MotionDistances(fit, distance, distance, flat), PARAMS)
    dear = description_length(MotionDistances(fit, distance, missing, flat), PARAMS)
    assert dear - both == pytest.approx(3 * 0.5 * np.log(100))


def resting_scene(num_movers: int) -> tuple[MotionTracks, np.ndarray]:
    """A wide background under a resting camera, and movers that each go their way; 0.05 px of noise."""
    rng = np.random.default_rng(0)
    owner = np.repeat(np.arange(num_movers + 1), [80, *[20] * num_movers])
    centre = np.array([[320, 240], [150, 120], [450, 350]])[owner]
    reach = np.where(owner == 0, 300, 40)[:, None]
    place = centre + rng.uniform(-1, 1, (len(owner), 2)) * reach
    step = np.array([[0, 0], [2.0, 0.5], [-1.0, 1.5]])[owner]
    points = place[:, None] + np.arange(6)[None, :, None] * step[:, None]
    points += rng.normal(scale=0.05, size=points.shape)
    return MotionTracks(points, np.ones(points.shape[:2], bool), owner), np.arange(num_movers + 1)


@pytest.mark.parametrize("num_movers", [0, 1, 2])
def test_movers_before_a_resting_camera_are_not_taken_for_parallax(num_movers):
    tracks, motion = resting_scene(num_movers)
    fits = EpipolarDistances((tracks,), len(motion), PARAMS, np.random.default_rng(0))
    assert fits.of(motion).is_flat.all()
    lengths = [description_length(fits.of(np.minimum(motion, count)), PARAMS) for count in range(num_movers + 1)]
    assert np.argmin(lengths) == num_movers


def test_flat_objects_of_a_deep_scene_do_not_make_it_flat():
    assert not distances_of([5], None).is_flat.any()
