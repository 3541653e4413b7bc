"""Masks, identities and numbers of motions."""

import re

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.synthetic import SCENES, render_scene
from moseg.tasks.synthetic.paths import compose, inverse, pose_of
from moseg.tasks.synthetic.scene import Scene


@pytest.mark.parametrize("name", SCENES)
def test_arrays_have_their_types_and_shapes(name, small, small_scene):
    scene = small(name)
    size = (small_scene(name).height, small_scene(name).width)
    tracks = len(scene.points)
    assert {field: (array.dtype.name, array.shape) for field, array in scene._asdict().items()} == {
        "images": ("uint8", (6, *size, 3)),
        "objects": ("uint16", (6, *size)),
        "moving": ("uint16", (6, *size)),
        "flow_forward": ("float32", (5, *size, 2)),
        "flow_backward": ("float32", (5, *size, 2)),
        "inverse_depth": ("float32", (6, *size)),
        "points": ("float32", (tracks, 6, 2)),
        "visible": ("bool", (tracks, 6)),
    }


@pytest.mark.parametrize("name", SCENES)
def test_moving_is_objects_without_the_static_ones(name, small, small_scene):
    scene, things = small(name), small_scene(name).things
    moving = [identity for identity, thing in enumerate(things, start=1) if thing.is_moving]
    np.testing.assert_array_equal(scene.moving, np.where(np.isin(scene.objects, moving), scene.objects, 0))


@pytest.mark.parametrize("name", SCENES)
def test_scene_has_several_prominent_objects_of_realistic_size(name, outlines, small_scene):
    objects = outlines(name).objects
    shares = np.bincount(objects.ravel(), minlength=len(small_scene(name).things) + 1) / objects.size
    assert 3 <= len(shares) - 1 <= 6
    # On a street the next cars hide most of those behind them.
    assert shares[1:].min() > (0.003 if name.startswith("drive-") else 0.008)
    assert shares[1:].max() < 0.2
    assert shares[0] > 0.6


def world_motions(scene):
    """Motion of each part from one frame to the next in the world, by object: lists of 3 x 4 matrices."""
    for thing in scene.things:
        motions = []
        for part in thing.parts:
            poses = [
                compose(
                    pose_of(thing.position.at(t), thing.angles.at(t)), pose_of(part.position.at(t), part.angles.at(t))
                )
                for t in (2, 3)
            ]
            step = compose(poses[1], inverse(poses[0]))
            motions.append(np.column_stack([step.rotation, step.translation]))
        yield motions


@pytest.mark.parametrize("name", SCENES)
def test_num_motions_counts_distinct_world_motions(name):
    scene = SCENES[name]
    distinct = [np.eye(3, 4)]
    for motions in world_motions(scene):
        is_rigid = all(np.allclose(motion, motions[0], atol=1e-9) for motion in motions)
        if not is_rigid or not any(np.allclose(motions[0], known, atol=1e-9) for known in distinct):
            distinct.append(motions[0])
    assert scene.num_motions == len(distinct)


@pytest.mark.parametrize("name", ["drive-parked-row", "nothing-moves"])
def test_static_scene_has_an_empty_truth(name, small):
    scene = small(name)
    assert not scene.moving.any()
    assert scene.objects.any()
    assert np.linalg.norm(scene.flow_forward, axis=-1).max() > 1.0


def test_late_entry_is_absent_first_and_stays_to_the_end(small, outlines):
    present = (outlines("late-entry").objects == 3).any(axis=(1, 2))
    assert not small("late-entry").moving.any()
    assert not present[:7].any()
    assert present[12:].all()


def test_occluded_mover_vanishes_and_returns(outlines):
    areas = (outlines("occlusion").objects == 2).sum(axis=(1, 2))
    assert areas[0] > 60
    assert areas.min() == 0
    assert areas[-1] > 60


def test_render_takes_any_size_and_length(small_scene):
    scene = small_scene("pan").model_copy(update={"height": 33, "width": 50, "num_frames": 2})
    assert render_scene(scene).images.shape == (2, 33, 50, 3)


def test_gap_in_the_backdrop_is_bad_input(small_scene):
    scene = small_scene("pan")
    with pytest.raises(InputError, match="does not fill"):
        render_scene(scene.model_copy(update={"backdrop": scene.backdrop[:1]}))


def test_moving_backdrop_is_refused(small_scene):
    fields = small_scene("pan").model_dump()
    fields["backdrop"][0]["position"]["velocity"] = (0.1, 0.0, 0.0)
    with pytest.raises(ValueError, match="backdrop moves"):
        Scene(**fields)


def test_sequences_are_declared_in_kebab_case_and_order_at_full_size():
    assert list(SCENES) == sorted(SCENES)
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", name) for name in SCENES)
    for name, scene in SCENES.items():
        expected = (188, 622, 16) if name.startswith("drive-") else (240, 426, 24)
        assert (scene.height, scene.width, scene.num_frames) == expected
    assert all(scene.description.endswith(".") and "\n" not in scene.description for scene in SCENES.values())


def test_scene_survives_json(small_scene):
    scene = small_scene("deforming")
    assert Scene.model_validate_json(scene.model_dump_json()) == scene
