import numpy as np
import pytest
from scipy.spatial.distance import pdist

from moseg.schemas.parameters import TrackParams
from moseg.tasks.tracks.corners import BLOCK_SIZE, strongest_corners, texture_strength
from moseg.tasks.tracks.medoids import covering_medoids
from moseg.tasks.tracks.sampling import interior, sample_points

NONE = np.zeros((0, 2), np.float32)


def checkers():
    """A board of four fields whose only corner lies between pixels 49 and 50."""
    image = np.zeros((100, 100), np.uint8)
    image[:50, :50] = image[50:, 50:] = 200
    return image


def test_the_strongest_corner_of_a_board_is_where_its_fields_meet():
    texture = texture_strength(checkers())
    (corner,) = strongest_corners(texture, np.ones((100, 100), bool), 1, spacing=10, taken=NONE)
    assert np.abs(corner - 49.5).max() <= BLOCK_SIZE / 2


def test_corners_keep_their_distance_also_to_points_already_there():
    texture = texture_strength(np.random.default_rng(0).integers(0, 256, (100, 100)).astype(np.uint8))
    taken = np.array([[50.0, 50.0]], np.float32)
    corners = strongest_corners(texture, np.ones((100, 100), bool), 30, spacing=9, taken=taken)
    assert len(corners) == 30
    assert pdist(np.concatenate([taken, corners])).min() >= 9


def test_medoids_cover_a_mask_evenly():
    mask = np.zeros((100, 100), bool)
    mask[10:90, 10:90] = True
    medoids = covering_medoids(mask, 4, num_candidates=400, spacing=1, taken=NONE, rng=np.random.default_rng(0))
    quadrants = {(x > 50, y > 50) for x, y in medoids}
    assert len(quadrants) == 4


def test_medoids_are_no_more_than_the_pixels():
    mask = np.zeros((20, 20), bool)
    mask[3, 4:7] = True
    medoids = covering_medoids(mask, 10, num_candidates=50, spacing=1, taken=NONE, rng=np.random.default_rng(0))
    assert sorted(map(tuple, medoids)) == [(4, 3), (5, 3), (6, 3)]


@pytest.mark.parametrize(("fraction", "expected"), [(1.0, 1), (0.0, 0)])
def test_the_corner_fraction_mixes_corners_and_medoids(fraction, expected):
    params = TrackParams(corner_fraction=fraction, corner_quality=0.5, points_per_object=8, spread=0)
    texture = texture_strength(checkers())
    points = sample_points(texture, np.ones((100, 100), bool), 8, NONE, params, np.random.default_rng(0))
    strongest = np.unravel_index(np.argmax(texture), texture.shape)[::-1]
    assert (points[0] == strongest).all() == expected


def test_a_quota_already_met_adds_nothing():
    taken = np.random.default_rng(0).uniform(10, 90, (8, 2)).astype(np.float32)
    points = sample_points(
        texture_strength(checkers()), np.ones((100, 100), bool), 8, taken, TrackParams(), np.random.default_rng(0)
    )
    assert points.shape == (0, 2)


def test_the_interior_leaves_border_and_outline_but_never_an_object():
    params = TrackParams(border=6, erosion=3)
    whole = interior(np.ones((60, 80), bool), params)
    assert not whole[:6].any() and not whole[:, -6:].any()
    square = np.zeros((60, 80), bool)
    square[20:40, 20:40] = True
    assert interior(square, params).sum() == 14 * 14
    thin = np.zeros((60, 80), bool)
    thin[30, 20:40] = True
    np.testing.assert_array_equal(interior(thin, params), thin)


@pytest.mark.parametrize("quota", [9, 25])
def test_points_keep_a_share_of_the_distance_of_a_full_grid(quota):
    texture = texture_strength(np.random.default_rng(0).integers(0, 256, (100, 100)).astype(np.uint8))
    params = TrackParams(corner_fraction=1.0, corner_quality=0.01, spread=0.5, border=0, erosion=0)
    points = sample_points(texture, np.ones((100, 100), bool), quota, NONE, params, np.random.default_rng(0))
    assert pdist(points).min() >= 0.5 * 100 / np.sqrt(quota)
