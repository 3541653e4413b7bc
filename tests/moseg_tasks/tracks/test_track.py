import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import TrackParams
from moseg.tasks.tracks import track_points

PARAMS = TrackParams(points_per_object=20, background_points=40)
STEP = np.array([1.25, -0.75])


def track(frames, masks, params=PARAMS, seed=0):
    return track_points(iter(frames), masks, params, np.random.default_rng(seed))


def still_masks(mask, num_frames):
    return np.repeat(mask[None], num_frames, axis=0)


@pytest.fixture
def drifting(drift, square):
    """Ten frames that move by STEP and the tracks in them; an object moves along."""
    masks = np.stack([square(round(60 + STEP[0] * t), round(40 + STEP[1] * t)) for t in range(10)])
    return drift(10), masks, track(drift(10), masks)


def test_points_follow_a_known_translation(drifting):
    _, _, tracks = drifting
    both = tracks.visible[:, :-1] & tracks.visible[:, 1:]
    steps = np.diff(tracks.points, axis=1)[both]
    assert len(steps) > 300
    assert np.abs(steps - STEP).max() < 0.1


def test_each_object_gets_its_quota_and_the_background_its_own(drifting):
    _, masks, tracks = drifting
    at_start = tracks.visible[:, 0]
    assert (tracks.object[at_start] == 0).sum() == 40
    assert (tracks.object[at_start] == 1).sum() == 20
    x, y = tracks.points[at_start, 0].astype(int).T
    np.testing.assert_array_equal(masks[0][y, x], tracks.object[at_start])


def test_shapes_types_and_zeros_where_not_visible(drifting):
    _, _, (points, visible, object) = drifting
    assert points.dtype == np.float32 and visible.dtype == bool and object.dtype == np.uint16
    assert points.shape == (len(object), 10, 2) and visible.shape == (len(object), 10)
    assert (points[~visible] == 0).all()


def test_a_track_is_one_run_of_frames(drifting):
    visible = drifting[2].visible
    starts = np.diff(np.pad(visible, ((0, 0), (1, 0))).astype(int), axis=1) == 1
    np.testing.assert_array_equal(starts.sum(axis=1), 1)


def test_no_point_comes_near_the_border(drift):
    tracks = track(drift(10, step=(4.0, 0.0)), np.zeros((10, 120, 180), np.uint16))
    x, y = np.moveaxis(tracks.points[tracks.visible], -1, 0)
    assert x.min() >= 6 and y.min() >= 6
    assert x.max() <= 179 - 6 and y.max() <= 119 - 6
    assert (tracks.visible[:, 0] & ~tracks.visible[:, -1]).sum() > 5


def test_a_point_outside_its_mask_is_dropped_at_the_check_and_kept_before(drift, square):
    # The texture moves right by 16 px until the check at frame 8 while the mask stays.
    masks = still_masks(square(60, 40), 9)
    tracks = track(drift(9, step=(2.0, 0.0)), masks, PARAMS.model_copy(update={"erosion": 0}))
    mine = tracks.object == 1
    before, after = tracks.visible[mine, 7], tracks.visible[mine, 8]
    left = before & (tracks.points[mine, 7, 0] + 2 > 99.6)
    assert left.sum() > 3
    assert not after[left].any()
    assert (tracks.points[mine, 7, 0][left] > 95).all()
    assert after.sum() == 20


def test_dropped_points_are_replaced_by_new_tracks_at_the_check(drift, square):
    masks = still_masks(square(60, 40), 12)
    tracks = track(drift(12, step=(2.0, 0.0)), masks)
    first = tracks.visible.argmax(axis=1)
    assert set(first) == {0, 8}
    new = (first == 8) & (tracks.object == 1)
    assert new.sum() >= 3
    assert (tracks.points[new, 8, 0] >= 60).all() and (tracks.points[new, 8, 0] <= 99).all()


def test_an_object_that_enters_between_checks_gets_points_at_the_next(drift, square):
    masks = np.zeros((10, 120, 180), np.uint16)
    masks[5:] = square(60, 40, label=3)
    tracks = track(drift(10, step=(0.0, 0.0)), masks)
    entered = tracks.object == 3
    assert entered.sum() == 20
    np.testing.assert_array_equal(tracks.visible[entered].argmax(axis=1), 8)


def test_frames_beyond_the_masks_extend_tracks_and_start_none(drift):
    masks = np.zeros((8, 120, 180), np.uint16)
    tracks = track(drift(12), masks)
    assert tracks.points.shape[1] == 12
    assert set(tracks.visible.argmax(axis=1)) == {0}
    assert tracks.visible[:, 11].sum() > 20


def test_equal_generators_give_equal_bytes_and_others_do_not(drifting):
    frames, masks, tracks = drifting
    again, other = track(frames, masks), track(frames, masks, seed=1)
    assert all(a.tobytes() == b.tobytes() for a, b in zip(tracks, again, strict=True))
    assert tracks.points.tobytes() != other.points.tobytes()


def test_inputs_may_be_read_only(drifting):
    frames, masks, tracks = drifting
    for array in [*frames, masks]:
        array.setflags(write=False)
    np.testing.assert_array_equal(track(frames, masks).points, tracks.points)


def test_a_lost_point_ends_its_track(drift):
    frames = drift(4, step=(0.0, 0.0))
    frames[2] = np.zeros_like(frames[2])
    tracks = track(frames, np.zeros((4, 120, 180), np.uint16))
    assert tracks.visible[:, 1].all()
    assert not tracks.visible[:, 2:].any()


def test_one_frame(drift, square):
    tracks = track(drift(1), square(60, 40)[None])
    assert tracks.points.shape == (60, 1, 2)
    assert tracks.visible.all()


def test_a_background_alone(drift):
    tracks = track(drift(3), np.zeros((3, 120, 180), np.uint16))
    assert len(tracks.object) == 40 and (tracks.object == 0).all()


def test_no_points_to_track(drift, square):
    no_masks = track(drift(3), np.zeros((0, 120, 180), np.uint16))
    assert no_masks.points.shape == (0, 3, 2) and no_masks.visible.shape == (0, 3)
    nothing = track([], np.zeros((0, 120, 180), np.uint16))
    assert nothing.points.shape == (0, 0, 2) and nothing.object.shape == (0,)
    at_the_border = track(drift(2), still_masks(square(0, 0, side=5), 2))
    assert set(at_the_border.object) == {0}


def test_a_textureless_frame_yields_no_lasting_track():
    tracks = track([np.full((120, 180, 3), 90, np.uint8)] * 3, np.zeros((3, 120, 180), np.uint16))
    assert not tracks.visible[:, 1:].any()


def test_fewer_frames_than_masks_and_other_sizes_are_refused(drift):
    with pytest.raises(InputError, match="fewer frames than masks"):
        track(drift(2), np.zeros((3, 120, 180), np.uint16))
    with pytest.raises(InputError, match=r"mask of frame 0; got \(60, 90\); expected \(120, 180\)"):
        track(drift(2), np.zeros((2, 60, 90), np.uint16))
