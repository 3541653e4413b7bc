"""Poses, ray hits and textures, each against its definition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.synthetic.paths import Path, Sway, compose, inverse, pose_of
from moseg.tasks.synthetic.props import texture
from moseg.tasks.synthetic.shapes import Billboard, Box, Ellipsoid, Plane
from moseg.tasks.synthetic.texture import SIZE, paint_texture, sample_texture

numbers = st.floats(-3.0, 3.0)
vectors = st.tuples(numbers, numbers, numbers)


def hit_points(shape, origin, towards, *bend):
    """Points where rays from `origin` through the targets (N, 3) meet the shape."""
    direction = np.asarray(towards, float) - origin
    depth = shape.hit(np.asarray(origin, float), tuple(direction.T), *bend)
    met = np.isfinite(depth)
    return met, origin + depth[met, None] * direction[met]


@given(vectors, vectors, vectors)
@settings(max_examples=30, deadline=None)
def test_inverse_undoes_a_pose(position, angles, point):
    pose = pose_of(position, tuple(60.0 * angle for angle in angles))
    there_and_back = compose(inverse(pose), compose(pose, pose_of(point, (0.0, 0.0, 0.0))))
    np.testing.assert_allclose(there_and_back.translation, point, atol=1e-12)
    np.testing.assert_allclose(pose.rotation @ pose.rotation.T, np.eye(3), atol=1e-12)


def test_positive_yaw_turns_right_and_positive_pitch_looks_up():
    forward = np.array([0.0, 0.0, 1.0])
    assert (pose_of((0.0, 0.0, 0.0), (0.0, 30.0, 0.0)).rotation @ forward)[0] > 0
    assert (pose_of((0.0, 0.0, 0.0), (30.0, 0.0, 0.0)).rotation @ forward)[1] < 0


def test_path_is_a_line_plus_sinusoids():
    path = Path(start=(1, 0, 0), velocity=(0, 2, 0), sways=(Sway(amplitude=(0, 0, 3), period=8),))
    assert path.at(2) == pytest.approx((1, 4, 3))
    assert not path.is_constant
    assert Path(start=(1, 2, 3)).is_constant


def test_box_is_met_at_its_near_face():
    met, points = hit_points(Box(size=(1, 1, 1)), (0.2, 0.1, -5), [(0.5, 0.5, 0), (4, 0, 0)])
    assert met.tolist() == [True, False]
    np.testing.assert_allclose(points[0, 2], -1.0)


@given(st.lists(vectors, min_size=1, max_size=20))
@settings(max_examples=30, deadline=None)
def test_hits_lie_on_the_ellipsoid_facing_the_ray(targets):
    radii, origin = np.array([1.0, 0.5, 0.7]), np.array([0.0, 0.0, -6.0])
    met, points = hit_points(Ellipsoid(size=tuple(radii)), origin, targets)
    np.testing.assert_allclose(((points / radii) ** 2).sum(axis=1), 1.0, atol=1e-9)
    outward = points / radii**2
    assert ((outward * (np.asarray(targets, float)[met] - origin)).sum(axis=1) <= 1e-9).all()


def test_surfaces_behind_the_camera_are_not_hit():
    for shape in (Plane(), Billboard(size=(1, 1)), Box(size=(1, 1, 1)), Ellipsoid(size=(1, 1, 1))):
        assert not hit_points(shape, (0, 0, 5), [(0, 0, 9)])[0].any()


def test_bend_and_its_reverse_cancel_and_move_the_outline():
    board, bend = Billboard(size=(0.5, 1.0), ripples=(0, 0, 0)), (0.0, 0.8, 0.0)
    material = np.array([[0.1, 0.9, 0.0], [0.0, -0.95, 0.0]])
    bent = board.bent(material, bend)
    np.testing.assert_allclose(board.bent(bent, bend, -1.0), material)
    # The lower edge (y = 1, h = 0) stays, the upper one (h = 1) moves by c2.
    assert abs(bent[0, 0] - 0.1) < 0.01 and bent[1, 0] > 0.7
    assert hit_points(board, (0, 0, -4), bent, bend)[0].all()
    assert not hit_points(board, (0, 0, -4), bent[1:])[0].any()


@pytest.mark.parametrize("pattern", ["blotches", "tiles", "planks"])
def test_texture_look_up(pattern):
    mipmap = paint_texture(texture("brick", 7, pattern=pattern))
    finest = mipmap.texels[: SIZE * SIZE].reshape(SIZE, SIZE, 3)
    u, v = np.array([3.5, 100.5, SIZE + 3.5]), np.array([8.5, 40.5, 8.5 - SIZE])
    colors = sample_texture(mipmap, u, v, np.full(3, 0.5))
    np.testing.assert_allclose(colors[:2], finest[[8, 40], [3, 100]], atol=1e-3)
    np.testing.assert_array_equal(colors[0], colors[2])
    far = sample_texture(mipmap, np.arange(0.0, SIZE), np.arange(0.0, SIZE), np.full(SIZE, 1e4))
    assert np.abs(far - finest.mean(axis=(0, 1))).max() < 60
    assert finest.std(axis=(0, 1)).min() > 12
