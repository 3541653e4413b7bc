"""Evidence of the tracks in an object's masks, of a wall and an object that a camera passes."""

from types import SimpleNamespace

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams, RigidSupportParams, SceneParallaxParams
from moseg.tasks.rigid_support import measure_objects, object_evidence

PARAMS, SCENE, RIGIDITY = RigidSupportParams(), SceneParallaxParams(), RigidityParams()
NEAR = 25.0
"""Depth of an object that stands before the wall, which is at 40."""
LEFT, SIDE, FAR_SPEED = 90, 40, 1.0
"""Place of the object, px, and speed of a wall behind the wall, px per frame."""


def measure(passage, num_objects=2, **changes):
    params = PARAMS.model_copy(update=changes)
    labels, *tracks = passage[:6]
    return measure_objects(labels, num_objects, *tracks, params, SCENE, RIGIDITY)


def test_an_object_on_the_wall_has_the_walls_depth(passage):
    evidence = measure(passage())
    assert evidence.attached.tolist() == [1, 1]
    assert evidence.num_contour[1] >= PARAMS.min_contour


def test_an_object_before_the_wall_has_another_depth(passage):
    evidence = measure(passage(NEAR))
    assert evidence.attached[1] == 0
    assert evidence.num_contour[1] >= PARAMS.min_contour


def test_what_the_noise_hides_may_have_the_walls_depth(passage):
    # The camera hardly travels: depths of which the parallax differs by 0.1 px are not told apart.
    assert measure(passage(NEAR, travel=0.01)).attached[1] == 1
    assert measure(passage(38.0)).attached[1] == 1
    assert measure(passage(38.0), depth_slack=0.0).attached[1] < 0.5


def test_only_tracks_near_the_contour_are_compared(passage):
    whole, narrow = measure(passage()), measure(passage(), contour_distance=7.0)
    per_pair = passage().is_object.sum()
    assert narrow.num_contour[1] < whole.num_contour[1] < per_pair
    assert not measure(passage(), contour_distance=0.5).num_contour.any()
    assert measure(passage(NEAR), contour_distance=0.5).attached[1] == 1


def test_other_objects_are_not_around_an_object(passage):
    scene = passage()
    everything = np.where(scene.labels == 1, 1, 2).astype(np.uint16)
    evidence = measure(scene._replace(labels=everything), 3)
    assert not evidence.num_contour.any()
    assert evidence.attached.tolist() == [1, 1, 1]
    assert evidence.num_observations[1:].all()


def alone(scene, distance=20):
    """Return the passage without tracks of the wall near the object, px."""
    apart = np.maximum(np.abs(scene.points[:, 0] - [LEFT + SIDE / 2, 60]) - SIDE / 2, 0).max(axis=1)
    return scene._replace(visible=scene.visible & (scene.is_object | (apart > distance))[:, None])


@pytest.mark.parametrize(("depth", "is_accompanied"), [(40.0, True), (38.0, True), (30.0, False), (60.0, False)])
def test_an_object_has_the_depth_of_the_scene_or_is_alone_at_its_own(passage, depth, is_accompanied):
    evidence = measure(alone(passage(depth)))
    assert evidence.num_contour[1] < PARAMS.min_contour
    assert evidence.accompanied.tolist() == [1, is_accompanied]


def beside_others(passage, number, **changes):
    """Return the evidence of a lone object while so many tracks at the right edge of the frame have its depth."""
    scene = alone(passage(NEAR))
    points, frames = scene.points.copy(), np.arange(scene.points.shape[1])
    others = np.flatnonzero(~scene.is_object & (points[:, 0, 0] > 180))[:number]
    assert len(others) == number
    speed = np.ptp(points[np.flatnonzero(scene.is_object)[0], :2, 0])
    points[others, :, 0] = points[others, :1, 0] - speed * frames
    return measure(scene._replace(points=points), **changes)


def test_as_many_tracks_must_have_the_objects_depth_as_a_contour_needs(passage):
    assert PARAMS.min_contour == 8
    assert [beside_others(passage, number).accompanied[1] for number in (7, 8)] == [0, 1]
    assert [beside_others(passage, 2, min_contour=count).accompanied[1] for count in (0, 1, 2, 2.5)] == [1, 1, 1, 0]


def test_what_the_rigid_scene_does_not_explain_gives_no_company(passage):
    scene = alone(passage())
    points = scene.points.copy()
    points[~scene.is_object, :, 1] += 2 * np.arange(points.shape[1])
    visible = scene.visible & (points[..., 1] < scene.labels.shape[1] - 1)
    assert measure(scene._replace(points=points, visible=visible)).accompanied[1] == 0
    assert measure(scene).accompanied[1] == 1


def test_other_objects_give_no_company(passage):
    scene = alone(passage())
    everything = np.where(scene.labels == 1, 1, 2).astype(np.uint16)
    assert measure(scene._replace(labels=everything), 4).accompanied.tolist() == [1, 0, 0, 1]


def test_what_is_in_an_object_in_the_second_frame_gives_no_company(passage):
    scene = alone(passage())
    labels = scene.labels.copy()
    labels[1:][labels[1:] == 0] = 2
    assert measure(scene, 3).accompanied[1] == 1
    assert measure(scene._replace(labels=labels), 3).accompanied[1] == 0


def test_others_whose_depth_hardly_shows_give_no_company():
    """As where the camera drives to: they may have any depth."""
    inside = np.arange(60) < 10
    depth = np.where(inside, 0.1, np.linspace(0.01, 0.02, 60))
    depth[-20:] = np.linspace(0.09, 0.11, 20)
    for reach, is_accompanied in ((100.0, True), (1.0, False)):
        parallax = SimpleNamespace(inverse_depth=depth, reach=np.where(np.arange(60) < 40, 100.0, reach))
        found = object_evidence._have_depth_of(~inside, inside, parallax, np.full(60, 0.5), PARAMS)
        assert found.tolist() == [is_accompanied] * 10


def test_tracks_inside_are_counted_in_the_mean_over_the_widest_pairs(passage):
    scene = passage()
    widest = scene.pairs[scene.pairs[:, 1] == 4]
    seen = [(scene.visible[:, [first, first + gap]].all(axis=1) & scene.is_object).sum() for first, gap in widest]
    assert len(widest) > 1 and measure(scene).num_inside[1] == pytest.approx(np.mean(seen))


def test_depths_are_compared_over_the_widest_pairs(passage):
    scene = passage(NEAR)
    turned = scene.cameras[0]._replace(translation=np.array([0.0, 1.0, 0.0]))
    narrow = scene.pairs[:, 1] < 4
    spoilt = [turned if is_narrow else camera for camera, is_narrow in zip(scene.cameras, narrow, strict=True)]
    whole, only = measure(scene), measure(scene._replace(cameras=spoilt))
    for name in ("attached", "num_contour", "accompanied"):
        np.testing.assert_array_equal(getattr(only, name), getattr(whole, name))
    swapped = [camera if is_narrow else turned for camera, is_narrow in zip(scene.cameras, narrow, strict=True)]
    assert measure(scene._replace(cameras=swapped)).attached[1] != whole.attached[1]


def test_the_test_is_the_mean_over_tracks_and_pairs(passage):
    scene = passage(test=1.0)
    assert measure(scene).test.tolist() == [0, 1]
    tests = scene.strict_test.copy()
    tests[::2, scene.is_object] = -1
    evidence = measure(scene._replace(strict_test=tests))
    seen = np.stack([scene.visible[:, [first, first + gap]].all(axis=1) for first, gap in scene.pairs])
    seen &= scene.is_object
    assert evidence.num_observations[1] == seen.sum()
    assert evidence.test[1] == pytest.approx(tests[seen].mean(dtype=float))


def test_tracks_that_are_not_seen_or_not_tested_are_no_observations(passage):
    scene = passage(test=1.0)
    num_observations = measure(scene).num_observations[1]
    hidden, untested = scene.visible.copy(), scene.strict_test.copy()
    rows = np.flatnonzero(scene.is_object & scene.visible.all(axis=1))[:3]
    hidden[rows] = False
    untested[:, rows] = np.nan
    for spoilt in (scene._replace(visible=hidden), scene._replace(strict_test=untested)):
        evidence = measure(spoilt)
        assert evidence.num_observations[1] == num_observations - len(rows) * len(scene.pairs)
        assert evidence.test[1] == 1


def test_a_track_that_leaves_the_object_is_no_observation(passage):
    scene = passage(test=1.0)
    labels = scene.labels.copy()
    labels[1:] = 0
    assert not measure(scene._replace(labels=labels)).num_observations.any()


def test_pairs_that_end_beyond_the_labels_are_not_read(passage):
    scene = passage(NEAR, num_frames=9)
    num_labelled = 6
    within = scene.pairs.sum(axis=1) < num_labelled
    tests = np.where(within[:, None], scene.strict_test, 3).astype(np.float16)
    evidence = measure(scene._replace(labels=scene.labels[:num_labelled], strict_test=tests))
    cut = scene._replace(
        labels=scene.labels[:num_labelled],
        pairs=scene.pairs[within],
        cameras=scene.cameras[: within.sum()],
        strict_test=scene.strict_test[within],
    )
    assert 0 < within.sum() < len(within)
    for found, expected in zip(evidence, measure(cut), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_an_object_without_tracks_has_no_evidence(passage):
    evidence = measure(passage(test=1.0), num_objects=4)
    assert evidence.num_observations[2:].tolist() == [0, 0]
    assert evidence.test[2:].tolist() == evidence.num_contour[2:].tolist() == [0, 0]
    assert evidence.attached[2:].tolist() == [1, 1]


def test_no_pair_is_no_evidence(passage):
    scene = passage()
    evidence = measure(scene._replace(pairs=scene.pairs[:0], cameras=[], strict_test=scene.strict_test[:0]))
    assert not evidence.num_observations.any()


def test_points_are_read_only_where_they_are_visible(passage):
    scene = passage(test=1.0)
    points = scene.points.copy()
    points[~scene.visible] = np.nan
    for found, expected in zip(measure(scene._replace(points=points)), measure(scene), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_points_have_the_label_of_the_nearest_pixel_also_at_the_frames_edge(passage):
    scene = passage()
    wall = np.flatnonzero(~scene.is_object)[:5]
    points, visible = scene.points.copy(), scene.visible.copy()
    right = scene.labels.shape[2] - 1
    points[wall[:3]], points[wall[3:]] = [right + 0.4, -0.4], [right - 0.4, 0.4]
    visible[wall] = True
    labels = scene.labels.copy()
    labels[:, 0, -1] = 2
    evidence = measure(scene._replace(labels=labels, points=points, visible=visible), 3)
    assert evidence.num_observations[2] == len(wall) * len(scene.pairs)


def test_points_beyond_the_frame_are_in_no_object_and_not_around_one(passage):
    scene = passage(test=1.0)
    points = scene.points.copy()
    points[..., 1] -= scene.labels.shape[1]
    evidence = measure(scene._replace(points=points, visible=np.ones_like(scene.visible)))
    assert not evidence.num_observations.any() and not evidence.num_contour.any() and evidence.gain == 0


def step_depths(scene):
    """Return the passage with a far wall on the right, outside of the object."""
    is_far = ~scene.is_object & (scene.points[:, 0, 0] > LEFT + SIDE)
    points = scene.points.copy()
    frames = np.arange(points.shape[1])
    points[is_far, :, 0] = points[is_far, :1, 0] - FAR_SPEED * frames
    return scene._replace(points=points), is_far


def test_the_gain_is_of_the_tracks_around_the_objects(passage):
    # The object alone is off the wall's plane: a rigid scene explains all tracks, but shows no depth around it.
    flat = passage(NEAR, spacing=4.0)
    assert measure(flat).gain == 0
    unlabelled = flat._replace(labels=np.zeros_like(flat.labels))
    assert measure(unlabelled).gain > 0.05
    stepped, is_far = step_depths(flat)
    assert measure(stepped).gain == pytest.approx(is_far.sum() / (~flat.is_object).sum(), abs=0.15)


def test_a_motion_that_explains_mostly_objects_shows_no_depth_around_them(passage):
    stepped, is_far = step_depths(passage(NEAR, spacing=4.0))
    near = np.flatnonzero(~stepped.is_object & ~is_far)[::10]
    few = np.isin(np.arange(len(is_far)), [*near[:30], *np.flatnonzero(is_far)[::10][:30]])
    scarce = stepped._replace(visible=stepped.visible & (stepped.is_object | few)[:, None])
    assert measure(scarce).gain == 0
    # The same tracks around an object with fewer of its own.
    fewer = np.arange(len(is_far)) % 5 == 0
    assert measure(scarce._replace(visible=scarce.visible & (fewer | ~scarce.is_object)[:, None])).gain > 0.2


def test_few_tracks_around_an_object_show_no_depth(passage):
    stepped, _ = step_depths(passage(NEAR, spacing=4.0))
    assert measure(stepped).gain > 0
    rows = np.flatnonzero(~stepped.is_object)[SCENE.min_tracks :]
    hidden = stepped.visible.copy()
    hidden[rows] = False
    assert measure(stepped._replace(visible=hidden)).gain == 0


def test_the_noise_of_the_tracks_around_an_object_counts_too(passage):
    # The wall moves by 16 px, the object by 25.6 px: 9.6 px < 0.34 hypot(16, 25.6) px.
    labels, *tracks = passage(NEAR)[:6]
    rigidity = RigidityParams(noise=1e-3, noise_share=0.34)
    assert measure_objects(labels, 2, *tracks, RigidSupportParams(depth_slack=0.0), SCENE, rigidity).attached[1] == 1
