"""Tracks of rendered drives: what moves deviates from a rigid scene, and what stands does not."""

from functools import cache
from importlib import import_module

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import DenseTrackParams, RigidityParams
from moseg.tasks.dense_tracks import track_densely
from moseg.tasks.rigidity import TRACK_EVIDENCE, estimate, estimate_rigidity
from moseg.tasks.synthetic import SCENES, render_scene

PARAMS = RigidityParams()
NUM_FRAMES = 6
CAR = 2
SPEEDS = {
    "parked": (0.0, 0.0, 0.0),
    "oncoming": (0.0, 0.0, -0.2),
    "crossing": (-0.1, 0.0, 0.0),
    "ahead": (0.0, 0.0, 0.2),
}


@cache
def drive(course):
    """Return a rendered street, its tracks and their evidence; the car moves by `SPEEDS` per frame."""
    scene = SCENES["forward-drive-epipolar-car"]
    car = scene.things[CAR - 1]
    path = car.position.model_copy(update={"velocity": SPEEDS[course]})
    things = (scene.things[0], car.model_copy(update={"position": path}), *scene.things[CAR:])
    rendered = render_scene(scene.model_copy(update={"things": things, "num_frames": NUM_FRAMES}))
    flows = zip(rendered.flow_forward, rendered.flow_backward, strict=True)
    tracks = track_densely(rendered.images, flows, DenseTrackParams())
    return rendered, tracks, estimate_rigidity(rendered.images, *tracks, PARAMS)


def evidence(course, has_depth=False):
    """Return the errors of all tracks and pairs, and the object that each is of."""
    rendered, tracks, found = drive(course)
    if has_depth:
        given = 7 * rendered.inverse_depth + 0.3
        found = estimate_rigidity(rendered.images, *tracks, PARAMS, given.__getitem__)
    errors, owners = [], []
    for (start, gap), error in zip(found.pairs, found.error, strict=True):
        seen = np.flatnonzero(np.isfinite(error))
        (x0, y0), (x1, y1) = (tracks.points[seen, t].round().astype(int).T for t in (start, start + gap))
        owner = rendered.objects[start][y0, x0]
        is_inside = owner == rendered.objects[start + gap][y1, x1]
        errors.append(error[seen][is_inside])
        owners.append(owner[is_inside])
    return np.concatenate(errors), np.concatenate(owners)


def test_a_street_with_a_parked_car_shows_hardly_any_evidence():
    error, owner = evidence("parked")
    assert np.mean(error[owner == 0] > 1) < 0.02
    assert np.mean(error[owner == CAR] > 1) < 0.02


@pytest.mark.parametrize("course", ["oncoming", "crossing"])
def test_a_car_that_moves_shows_evidence_and_the_street_does_not(course):
    error, owner = evidence(course)
    assert np.mean(error[owner == CAR] > 1) > 0.9
    assert np.mean(error[owner == 0] > 1) < 0.03


@pytest.mark.parametrize("course", ["ahead", "oncoming"])
def test_given_depth_tells_a_car_that_stays_on_its_epipolar_lines(course):
    error, owner = evidence(course, has_depth=True)
    assert np.mean(error[owner == CAR] > 1) > 0.9
    assert np.mean(error[owner == 0] > 1) < 0.03


def test_a_parked_car_stands_at_its_given_depth():
    error, owner = evidence("parked", has_depth=True)
    assert np.mean(error[owner == 0] > 1) < 0.02
    assert np.mean(error[owner != 0] > 1) < 0.02


def test_a_tracker_that_stays_on_a_marking_along_the_road_is_no_evidence():
    rendered, tracks, _ = drive("parked")
    height, width = rendered.images.shape[1:3]
    vanishing = np.array([(width - 1) / 2, (height - 1) / 2])
    foot, lane = np.array([[[0.68, 1.1], [0.76, 1.1]], [[0.5, 1.1], [0.9, 1.1]]]) * [width, height]
    images = rendered.images.copy()
    for image in images:
        for edges, level in ((lane, 80), (foot, 235)):
            cv2.fillPoly(image, [np.rint([vanishing, *edges]).astype(np.int32)], (level,) * 3, cv2.LINE_AA)
    stays = vanishing + np.linspace(0.4, 0.75, 12)[:, None] * (foot[0] - vanishing)
    points = np.concatenate([tracks.points, np.repeat(stays[:, None], NUM_FRAMES, axis=1)]).astype(np.float32)
    visible = np.concatenate([tracks.visible, np.ones((len(stays), NUM_FRAMES), bool)])
    asked, ignored = (
        estimate_rigidity(images, points, visible, PARAMS.model_copy(update=changes)).strict_error[:, -len(stays) :]
        for changes in ({"test_roundness": 0.0}, {})
    )
    assert np.nanmedian(asked) > 1
    assert np.nanmax(ignored) < 0.5


def test_values_are_finite_where_a_track_is_seen_in_the_pair_and_nan_elsewhere():
    _, tracks, found = drive("crossing")
    np.testing.assert_array_equal(found.pairs, [(t, gap) for gap in (2, 4) for t in range(NUM_FRAMES - gap)])
    arrays = [getattr(found, name) for name in TRACK_EVIDENCE]
    for (start, gap), *values in zip(found.pairs, *arrays, strict=True):
        seen = tracks.visible[:, start] & tracks.visible[:, start + gap]
        for value in values:
            np.testing.assert_array_equal(np.isfinite(value), seen)
            np.testing.assert_array_equal(np.isnan(value), ~seen)
    assert {values.dtype for values in arrays} == {np.dtype(np.float16)}
    assert min(np.nanmin(values) for values in (found.error, found.median_error, found.strict_error)) >= 0
    assert min(np.nanmin(values) for values in (found.test, found.strict_test)) >= -1
    assert max(np.nanmax(values) for values in (found.test, found.strict_test)) <= PARAMS.test_limit


def test_two_surfaces_in_a_patch_leave_no_more_evidence_than_one():
    _, _, found = drive("crossing")
    seen = np.isfinite(found.error)
    assert (found.strict_error <= found.median_error)[seen].all()
    assert (found.strict_test <= found.test)[seen].all()
    assert (found.strict_test < found.test)[seen].any()
    # A mover keeps what moves like nothing rigid.
    moving = seen & (found.median_error > 2)
    assert np.mean(found.strict_error[moving] > 1) > 0.8


def test_the_evidence_is_the_same_bytes_each_time():
    rendered, tracks, found = drive("crossing")
    again = estimate_rigidity(rendered.images, *tracks, PARAMS)
    for name in ("pairs", *TRACK_EVIDENCE):
        assert getattr(again, name).tobytes() == getattr(found, name).tobytes()


@pytest.mark.parametrize("shape", [(64, 64), (1, 1), (375, 40)])
@pytest.mark.parametrize("num_frames", [1, 3, 6])
@pytest.mark.parametrize("num_tracks", [0, 1, 30])
def test_frames_or_tracks_too_few_for_a_camera_give_no_pairs(shape, num_frames, num_tracks):
    frames = np.zeros((num_frames, *shape, 3), np.uint8)
    points = np.zeros((num_tracks, num_frames, 2), np.float32)
    found = estimate_rigidity(frames, points, np.ones((num_tracks, num_frames), bool), PARAMS)
    assert found.pairs.shape == (0, 2)
    assert {getattr(found, name).shape for name in TRACK_EVIDENCE} == {(0, num_tracks)}
    assert found.evidence == ()


@pytest.mark.parametrize("motion", ["none", "pan", "random", "grid"])
def test_tracks_of_any_motion_give_finite_evidence(wander, motion):
    found = estimate_rigidity(*wander(motion), PARAMS)
    for name in TRACK_EVIDENCE:
        assert np.isfinite(getattr(found, name)).all()


def test_with_a_step_the_evidence_of_the_pairs_that_are_read_is_the_same():
    rendered, tracks, every = drive("crossing")
    some = estimate_rigidity(rendered.images, *tracks, PARAMS, step=2)
    is_read = every.pairs[:, 0] % 2 == 0
    np.testing.assert_array_equal(some.pairs, every.pairs[is_read])
    np.testing.assert_array_equal(some.strict_test, every.strict_test[is_read])


@pytest.mark.parametrize(
    ("apart", "beyond"),
    [((1,), {0: [3], 1: [0, 4], 2: [1, 5], 3: [2]}), ((1, 3), {0: [3, 5], 3: [2, 0]}), ((9,), {0: []})],
)
def test_what_stands_still_is_sought_in_frames_before_and_after_the_pair(monkeypatch, apart, beyond):
    rendered, tracks, _ = drive("crossing")
    frames = [estimate._smooth_gray(image, PARAMS.test_blur) for image in rendered.images]
    found, measure = {}, estimate.pair_evidence

    def index_of(image):
        return next(index for index, frame in enumerate(frames) if np.array_equal(frame, image))

    def record(images, *args):
        found[index_of(images[0])] = [index_of(image) for image in args[-1]]
        return measure(images, *args)

    monkeypatch.setattr(estimate, "pair_evidence", record)
    estimate_rigidity(rendered.images, *tracks, RigidityParams(gaps=(2,), test_still_frames=apart))
    assert {start: found[start] for start in beyond} == beyond
    assert sorted(found) == [0, 1, 2, 3]


def test_the_frames_around_a_pair_reach_the_patch_test(monkeypatch):
    module, found = import_module("moseg.tasks.rigidity.evidence"), []
    compare = module.compare_patches

    def record(*args):
        found.append(args[-1])
        return compare(*args)

    rendered, tracks, _ = drive("crossing")
    monkeypatch.setattr(module, "compare_patches", record)
    estimate_rigidity(rendered.images, *tracks, RigidityParams(gaps=(2,), test_still_frames=(1,)))
    assert [len(others) for others in found] == [1, 2, 2, 1]
