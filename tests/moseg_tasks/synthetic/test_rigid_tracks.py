"""Generated tracks of rigid objects."""

import numpy as np
import pytest

from moseg.tasks.geometry.eight_point import eight_point
from moseg.tasks.geometry.sampson import sampson_squared
from moseg.tasks.synthetic.rigid_tracks import IMAGE_SHAPE, rigid_tracks


@pytest.mark.parametrize("num_objects", [(6, 1, 1), (4, 2, 2)])
def test_each_motion_obeys_one_epipolar_geometry_and_no_other_does(num_objects):
    tracks = rigid_tracks(num_objects, 6, 30, 0.0, np.random.default_rng(0))
    motion = tracks.motion[tracks.owner]
    points0, points1 = tracks.points[:, 0], tracks.points[:, 3]
    for index in range(len(num_objects)):
        own = motion == index
        squared = sampson_squared(eight_point(points0[own], points1[own]), points0, points1)
        assert squared[own].max() < 1e-12
        assert np.median(squared[~own]) > 1.0


def test_objects_stand_in_random_order_with_as_many_tracks_each():
    scenes = [rigid_tracks((3, 1, 2), 4, 10, 0.1, np.random.default_rng(seed)) for seed in range(10)]
    assert len({tuple(scene.motion) for scene in scenes}) > 5
    for scene in scenes:
        assert np.bincount(scene.motion).tolist() == [3, 1, 2]
        assert np.bincount(scene.owner).tolist() == [10] * 6


def test_tracks_are_visible_inside_the_frame_alone():
    tracks = rigid_tracks((6, 1, 1), 40, 25, 0.0, np.random.default_rng(1))
    height, width = IMAGE_SHAPE
    seen = tracks.points[tracks.visible]
    assert 0.3 < tracks.visible.mean() < 1.0
    assert (seen >= -0.5).all()
    assert (seen <= [width - 0.5, height - 0.5]).all()


def test_noise_is_of_the_size_asked_for():
    exact, noisy = (rigid_tracks((6, 1, 1), 6, 50, noise, np.random.default_rng(2)) for noise in (0.0, 0.3))
    assert np.std(noisy.points - exact.points) == pytest.approx(0.3, rel=0.05)
