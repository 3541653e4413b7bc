"""Point tracks: visible means seen, and every object that shows itself is tracked."""

import numpy as np
import pytest

from moseg.tasks.synthetic import SCENES


def objects_around(objects, points):
    """Identities at the four pixels about each point (N, 2): (N, 4)."""
    height, width = objects.shape
    x0, y0 = np.clip(np.floor(points).astype(int), 0, [width - 2, height - 2]).T
    return np.stack([objects[y0 + dy, x0 + dx] for dy in (0, 1) for dx in (0, 1)], axis=1)


def owners(objects, points, visible):
    """Object of each track, read at the seeding frame, where the point lies on a pixel inside the object."""
    identity = np.full(len(points), -1)
    for t in range(0, len(objects), 6):
        fresh = (identity < 0) & visible[:, t] & (points[:, t] == np.rint(points[:, t])).all(axis=1)
        x, y = points[fresh, t].astype(int).T
        identity[fresh] = objects[t, y, x]
    return identity


@pytest.mark.parametrize("name", SCENES)
def test_visible_points_lie_in_the_frame_on_their_object(name, outlines):
    objects, (points, visible) = outlines(name)
    identity = owners(objects, points, visible)
    assert (identity >= 0).all()
    num_frames, height, width = objects.shape
    for t in range(num_frames):
        seen, at = visible[:, t], points[visible[:, t], t]
        assert (at >= 0).all() and (at <= [width - 1, height - 1]).all()
        on_object = (objects_around(objects[t], at) == identity[seen, None]).any(axis=1)
        assert on_object.mean() > 0.99


@pytest.mark.parametrize("name", SCENES)
def test_every_object_is_tracked(name, outlines):
    objects, (points, visible) = outlines(name)
    tracked = np.bincount(owners(objects, points, visible), minlength=objects.max() + 1)
    assert tracked[0] >= 300
    assert tracked[1:].min() >= 20


def test_hidden_mover_has_no_visible_points(outlines):
    objects, (points, visible) = outlines("occlusion")
    on_ball = owners(objects, points, visible) == 2
    hidden = ~(objects == 2).any(axis=(1, 2))
    assert hidden.any()
    assert not visible[on_ball][:, hidden].any()
    assert visible[on_ball][:, 0].any()


def test_points_that_leave_the_frame_turn_invisible(outlines):
    points, visible = outlines("forward-drive-epipolar-car").tracks
    outside = ((points < 0) | (points > [105, 59])).any(axis=2)
    assert outside.any()
    assert not visible[outside].any()


def test_points_are_always_finite(outlines):
    assert np.isfinite(outlines("forward-drive-epipolar-car").tracks.points).all()
