"""Points of moving objects that are followed by the motion of the whole object."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import ObjectPointParams
from moseg.tasks.object_points import follow_objects

NUM_FRAMES, HEIGHT, WIDTH = 7, 160, 240
SIDE = 30
GROWTH = 1.25
"""Of the square, from one frame to the next."""
PARAMS = ObjectPointParams()
RNG = np.random.default_rng(5)
SCENE, SKIN = (
    cv2.normalize(cv2.GaussianBlur(RNG.normal(size=shape), (0, 0), blur), None, 0, 255, cv2.NORM_MINMAX)
    for shape, blur in (((HEIGHT, WIDTH), 1.5), ((160, 160), 6.0))
)
TRACKED = np.float32([[x, y] for x in (4, 11, 19, 26) for y in (5, 12, 20, 25)])
"""Points of the square's skin at its first size, px."""
STILL = np.float32([[x, y] for x in range(10, 236, 15) for y in range(10, 156, 15)])


def _corner(frame):
    return np.array([20.0 + 6 * frame, 20.0 + 4 * frame])


def _place(points, frame):
    return (_corner(frame) + points * GROWTH**frame).astype(np.float32)


def _frame(frame, *, hidden=False):
    scale = SIDE * GROWTH**frame / 160
    to_frame = np.hstack([scale * np.eye(2), _corner(frame)[:, None]])
    skin, is_skin = (
        cv2.warpAffine(layer, to_frame, (WIDTH, HEIGHT), flags=cv2.INTER_LINEAR) for layer in (SKIN, np.ones_like(SKIN))
    )
    image = np.where((is_skin > 0.5) & (not hidden), skin, SCENE)
    return np.repeat(image.astype(np.uint8)[..., None], 3, axis=2)


FRAMES = [_frame(frame) for frame in range(NUM_FRAMES)]


def _tracks(seen, *, label=1):
    """Return points, visible and objects: points of the square in the frames `seen`, and those of the scene."""
    places = np.stack([_place(TRACKED, frame) for frame in range(NUM_FRAMES)], axis=1)
    scene = np.repeat(STILL[:, None], NUM_FRAMES, axis=1)
    visible = np.zeros((len(TRACKED) + len(STILL), NUM_FRAMES), bool)
    visible[: len(TRACKED), list(seen)] = True
    for frame in range(NUM_FRAMES):
        inside = (_corner(frame) <= STILL) & (_corner(frame) + SIDE * GROWTH**frame >= STILL)
        visible[len(TRACKED) :, frame] = ~inside.all(axis=1)
    objects = np.r_[np.full(len(TRACKED), label), np.zeros(len(STILL), int)].astype(np.uint16)
    return np.concatenate([places, scene]), visible, objects


def _errors(found, frame):
    """Return how far the object's points lie outside of the square in a frame, px."""
    places = found.points[found.visible[:, frame] & (found.object > 0), frame]
    side = SIDE * GROWTH**frame
    beyond = np.maximum(_corner(frame) - places, places - _corner(frame) - side)
    return beyond.max(axis=1)


@pytest.fixture(scope="module")
def followed():
    return follow_objects(FRAMES.__getitem__, *_tracks(range(2)), PARAMS)


def test_points_whose_tracks_end_are_followed_to_the_last_frame(followed):
    for frame in range(2, NUM_FRAMES):
        assert len(_errors(followed, frame)) >= len(TRACKED)
        assert np.median(_errors(followed, frame)) < 0
        assert (_errors(followed, frame) < PARAMS.patch).all()


def test_points_are_followed_backward_too():
    found = follow_objects(FRAMES.__getitem__, *_tracks(range(5, NUM_FRAMES)), PARAMS)
    for frame in range(2, 5):
        assert len(_errors(found, frame)) >= len(TRACKED)
        assert np.median(_errors(found, frame)) < 0


def test_a_lost_track_goes_on_where_the_object_brings_it():
    # Without new corners only the tracks themselves are followed.
    found = follow_objects(FRAMES.__getitem__, *_tracks(range(2)), PARAMS.model_copy(update={"reach": 0.0}))
    assert 0 < len(found.object) <= len(TRACKED)
    for frame in range(2, NUM_FRAMES):
        places = found.points[found.visible[:, frame], frame]
        nearest = np.linalg.norm(places[:, None] - _place(TRACKED, frame), axis=2).min(axis=1)
        assert len(places) > len(TRACKED) / 2
        assert np.median(nearest) < 1.5


def test_corners_join_the_object_or_the_background_by_their_motion(followed):
    still = np.flatnonzero(followed.object == 0)
    assert len(still)
    for point in still:
        first, last = followed.points[point, followed.visible[point]]
        np.testing.assert_allclose(first, last, atol=1)
    assert set(followed.object) == {0, 1}


def test_each_point_has_one_run_of_frames_and_no_place_elsewhere(followed):
    steps = np.diff(followed.visible.astype(int), axis=1, prepend=0, append=0)
    np.testing.assert_array_equal((steps == 1).sum(axis=1), 1)
    assert not followed.points[~followed.visible].any()


def test_a_plain_surface_that_an_encoder_moves_along_is_not_the_objects():
    # Around the square, a faint pattern moves with it, as blocks do that are copied from the frame before.
    rng = np.random.default_rng(3)
    faint = cv2.GaussianBlur(rng.normal(size=(320, 320)), (0, 0), 4)
    faint = (90 + 3 * faint / faint.std()).astype(np.float32)
    frames = []
    for frame in range(NUM_FRAMES):
        scale = SIDE * GROWTH**frame / 160
        to_frame = np.hstack([scale * np.eye(2), _corner(frame)[:, None] - scale * 80])
        around, is_around = (
            cv2.warpAffine(layer, to_frame, (WIDTH, HEIGHT), flags=cv2.INTER_LINEAR)
            for layer in (faint, np.ones_like(faint))
        )
        rows, columns = np.mgrid[:HEIGHT, :WIDTH]
        corner, side = _corner(frame), SIDE * GROWTH**frame
        inside = (columns >= corner[0]) & (columns <= corner[0] + side)
        inside &= (rows >= corner[1]) & (rows <= corner[1] + side)
        image = np.where((is_around > 0.5) & ~inside, around, FRAMES[frame][..., 0])
        frames.append(np.repeat(image.astype(np.uint8)[..., None], 3, axis=2))
    points, visible, objects = _tracks(range(2))
    for frame in range(NUM_FRAMES):
        distance = np.abs(STILL - _corner(frame) - SIDE * GROWTH**frame / 2).max(axis=1)
        visible[len(TRACKED) :, frame] &= distance > SIDE * GROWTH**frame
    stray = []
    for changes in ({"min_contrast": 0.0}, {}):
        found = follow_objects(frames.__getitem__, points, visible, objects, PARAMS.model_copy(update=changes))
        beyond = np.concatenate([_errors(found, frame) for frame in range(2, NUM_FRAMES)])
        stray.append(np.count_nonzero(beyond > PARAMS.patch / 2))
    assert stray[0] > 100 and stray[1] < 0.05 * stray[0]


def test_points_end_where_something_hides_the_object():
    frames = [*FRAMES[:4], *(_frame(frame, hidden=True) for frame in range(4, NUM_FRAMES))]
    found = follow_objects(frames.__getitem__, *_tracks(range(2)), PARAMS)
    assert found.visible[found.object > 0][:, 3].sum() > len(TRACKED) / 2
    assert found.visible[found.object > 0][:, 5:].sum() <= 2


def test_points_that_something_hides_end():
    # A strip of the scene stands before the object in the last two frames.
    hidden = [frame.copy() for frame in FRAMES[:5]]
    for frame in (3, 4):
        hidden[frame][:, 62:76] = _frame(frame, hidden=True)[:, 62:76]
    points, visible, objects = _tracks(range(2))
    found = follow_objects(hidden.__getitem__, points[:, :5], visible[:, :5], objects, PARAMS)
    places = found.points[found.visible[:, 4] & (found.object > 0), 4]
    assert len(places) > 8
    assert (abs(places[:, 0] - 69) < 5).mean() < 0.1


def test_a_track_of_the_scene_that_counted_as_the_objects_is_not_followed():
    points, visible, objects = _tracks(range(2))
    stray = len(TRACKED) + np.flatnonzero((STILL == [190, 115]).all(axis=1))
    objects[stray], visible[stray, 2:] = 1, False
    found = follow_objects(FRAMES.__getitem__, points, visible, objects, PARAMS)
    near = np.linalg.norm(found.points - [190, 115], axis=2) < 20
    assert not (near & found.visible)[found.object > 0][:, 2:4].any()


@pytest.mark.parametrize(
    "changes",
    [{"gain": 1.9}, {"min_corner_correlation": 0.9999}, {"min_roundness": 0.9}],
    ids=lambda each: next(iter(each)),
)
def test_a_stricter_test_of_corners_leaves_fewer(followed, changes):
    found = follow_objects(FRAMES.__getitem__, *_tracks(range(2)), PARAMS.model_copy(update=changes))
    assert (found.object > 0).sum() < 0.7 * (followed.object > 0).sum()


def test_points_end_where_patches_correlate_less_than_is_asked():
    asked = PARAMS.model_copy(update={"min_correlation": 0.9999, "reach": 0.0})
    assert not len(follow_objects(FRAMES.__getitem__, *_tracks(range(2)), asked).object)


def test_new_corners_of_few_frames_do_not_count():
    found = follow_objects(FRAMES.__getitem__, *_tracks(range(2)), PARAMS.model_copy(update={"min_frames": 6}))
    long, kept = (
        followed_lengths(follow_objects(FRAMES.__getitem__, *_tracks(range(2)), PARAMS)),
        followed_lengths(found),
    )
    assert (long < 6).sum() > (kept < 6).sum()
    assert len(kept) < len(long)


def followed_lengths(found):
    return found.visible[found.object > 0].sum(axis=1)


@pytest.mark.parametrize("why", ["no object", "no motions", "no tracks", "one frame"])
def test_nothing_is_followed_without_what_it_needs(why):
    points, visible, objects = _tracks(range(2))
    params = PARAMS
    if why == "no object":
        objects = objects * 0
    elif why == "no motions":
        params = PARAMS.model_copy(update={"max_motions": 0})
    elif why == "no tracks":
        points, visible, objects = points[:0], visible[:0], objects[:0]
    else:
        points, visible = points[:, :1], visible[:, :1]
    found = follow_objects(FRAMES.__getitem__, points, visible, objects, params)
    assert found.points.shape == (0, points.shape[1], 2)
    assert found.visible.shape == (0, points.shape[1])
    assert found.object.dtype == np.uint16


def test_points_keep_the_label_of_their_object():
    found = follow_objects(FRAMES.__getitem__, *_tracks(range(2), label=4), PARAMS)
    assert set(found.object) == {0, 4}


def test_the_same_points_are_found_each_time(followed):
    again = follow_objects(FRAMES.__getitem__, *_tracks(range(2)), PARAMS)
    for one, other in zip(followed, again, strict=True):
        np.testing.assert_array_equal(one, other)
