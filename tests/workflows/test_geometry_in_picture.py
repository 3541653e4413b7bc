"""Geometry inside black bars: tracks, cameras and objects of a film with bars are those of its picture, moved."""

from contextlib import nullcontext

import numpy as np
import pytest
from scipy.spatial import cKDTree

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.tasks.synthetic import SCENES, render_scene
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.registry import find_stage

BARS = BlackBars(left=36, top=52, right=0, bottom=17)
NUM_FRAMES = 8
AFTER_TRACKS = ("rigidity", "moving_tracks", "track_groups", "track_surfaces", "track_objects", "object_points")


class _View:
    """The part of an artifact that tasks read."""

    def __init__(self, arrays, attributes=None):
        self._arrays, self.attributes = arrays, attributes or {}

    def array(self, name):
        return self._arrays[name]

    cached = array

    def shape(self, name):
        return self._arrays[name].shape


class _Inputs(dict):
    def all(self, role):
        return self[role]


class _Film:
    """A film of which stages are computed, with bars or, where `bars` is None, without."""

    def __init__(self, scene, bars):
        self.scene, self.bars = scene, bars
        self.config = PipelineConfig()
        self.place = {} if bars is None else {"bars": bars}
        self.frames = [_View({"image": self.padded(image)}) for image in scene.images]
        self.found = {}

    def padded(self, array, value=90):
        """Return an array (y, x, ...) inside bars of some value."""
        if self.bars is None:
            return array
        beside = ((self.bars.top, self.bars.bottom), (self.bars.left, self.bars.right))
        return np.pad(array, (*beside, *((0, 0),) * (array.ndim - 2)), constant_values=value)

    def compute(self, name, task=None, inputs=None, **place):
        """Compute a stage on the outputs of those before it, and return its output."""
        stage = find_stage(name)
        task = task or stage.task(stage.chosen(self.config))
        given = _Inputs({"frames": self.frames, **self.found, **(inputs or {})})
        output = task.run(task.params(self.config, **place), given, np.random.default_rng(0))
        self.found[name] = _View(output.arrays, output.attributes)
        return output

    def compute_objects(self):
        """Compute everything from dense tracks to the points of objects."""
        flows = {
            "flow_forward": [_View({"flow": self.padded(flow, 0)}) for flow in self.scene.flow_forward],
            "flow_backward": [_View({"flow": self.padded(flow, 0)}) for flow in self.scene.flow_backward],
        }
        self.compute("dense_tracks", inputs=flows, **self.place)
        shape = {"shape": self.frames[0].shape("image")[:2]}
        for name in AFTER_TRACKS:
            reads_shape = name in ("track_surfaces", "track_objects")
            reads_place = reads_shape or name in ("rigidity", "object_points")
            self.compute(name, **(self.place if reads_place else {}), **(shape if reads_shape else {}))


@pytest.fixture(scope="module")
def films():
    """Return a drive towards a car without and with bars, with all that follows from its frames."""
    scene = render_scene(SCENES["drive-oncoming-car"])
    frames = slice(-NUM_FRAMES, None)
    pairs = slice(1 - NUM_FRAMES, None)
    scene = scene._replace(
        images=scene.images[frames],
        moving=scene.moving[frames],
        flow_forward=scene.flow_forward[pairs],
        flow_backward=scene.flow_backward[pairs],
    )
    films = _Film(scene, None), _Film(scene, BARS)
    for film in films:
        film.compute_objects()
    return films


def _points(film, name):
    return (film.found[name].array(part) for part in ("points", "visible"))


def test_tracks_are_those_of_the_picture_at_their_place_in_the_frame(films):
    (plain, visible), (moved, still_visible) = (_points(film, "dense_tracks") for film in films)
    np.testing.assert_array_equal(visible, still_visible)
    assert visible.any() and not moved[~visible].any()
    np.testing.assert_allclose(moved[visible], plain[visible] + BARS.corner, atol=1e-4)


def test_objects_are_followed_in_the_picture(films):
    """They start from places that were rounded once more, so that single points may differ."""
    (plain, visible), (moved, still_visible) = (_points(film, "object_points") for film in films)
    assert visible.any() and not moved[~still_visible].any()
    trees = cKDTree(plain[visible]), cKDTree(moved[still_visible] - np.float32(BARS.corner))
    for one, other in (trees, trees[::-1]):
        assert np.mean(one.query(other.data)[0] < 0.1) > 0.95


def test_rigidity_is_that_of_the_picture(films):
    plain, barred = (film.found["rigidity"] for film in films)
    assert plain.attributes["focal"] == barred.attributes["focal"]
    assert any(pair["ground"] for pair in plain.attributes["cameras"])
    errors, moved = (each.array("strict_error").astype(float) for each in (plain, barred))
    # Places are rounded to float32 once more.
    assert np.isclose(errors, moved, rtol=0.05, atol=0.05, equal_nan=True).mean() > 0.99


def test_surfaces_and_objects_are_those_of_the_picture(films):
    for name, part in (("track_surfaces", "surface"), ("track_objects", "object"), ("track_objects", "is_moving")):
        plain, moved = (film.found[name].array(part) for film in films)
        assert plain.any() and np.mean(plain == moved) > 0.98


def test_support_is_that_of_the_picture(films):
    supports = []
    for film in films:
        masks = np.stack([film.padded(mask, 0) for mask in film.scene.moving > 0]).astype(np.uint16)
        inputs = {
            "proposals": _View({"masks": masks}),
            "linking": _View({"identity": np.array([[0, 1]], np.uint16)}, {"num_objects": 2}),
        }
        place = {"section": 0, "start": 0, "min_gain": 0.0, **film.place}
        supports.append(film.compute("rigid_support", find_stage("rigid_support").task("masks"), inputs, **place))
    plain, barred = supports
    np.testing.assert_array_equal(plain.arrays["support"], barred.arrays["support"])
    assert plain.attributes["num_observations"] == barred.attributes["num_observations"]
    np.testing.assert_allclose(plain.attributes["test"], barred.attributes["test"], atol=0.02)
    np.testing.assert_allclose(plain.attributes["attached"], barred.attributes["attached"], atol=0.05)


def test_the_cameras_motion_is_that_in_the_picture(films):
    plain, barred = (film.compute("scene_parallax", pairs=[(0, 3), (4, 7)], **film.place) for film in films)
    assert plain.attributes == barred.attributes


def test_networks_of_cameras_see_the_picture_and_depth_is_read_there(films, monkeypatch):
    from moseg.workflows.stages import cameras

    seen = []

    def estimate(network, images, *_):
        seen.append(images)
        raise InterruptedError

    monkeypatch.setattr("moseg.tasks.cameras.estimate_cameras", estimate)
    monkeypatch.setattr(cameras, "open_network", lambda *_: nullcontext())
    for film in films:
        with pytest.raises(InterruptedError):
            film.compute("cameras", cameras.DECODER, {"weights": None}, **film.place)
    np.testing.assert_array_equal(*seen)


def test_given_depth_is_read_at_the_tracks_of_the_picture(films):
    config = PipelineConfig.model_validate({"depth": {"method": "groundtruth"}})
    errors = []
    for film in films:
        depth = [_View({"inverse_depth": film.padded(each, np.nan)}) for each in film.scene.inverse_depth[-NUM_FRAMES:]]
        task = find_stage("rigidity").tasks[0]
        inputs = _Inputs({"frames": film.frames, "depth": depth, "dense_tracks": film.found["dense_tracks"]})
        output = task.run(task.params(config, **film.place), inputs, None)
        errors.append(output.arrays["error"].astype(float))
    assert np.isclose(*errors, rtol=0.05, atol=0.05, equal_nan=True).mean() > 0.99


def _recipes(bars, **values):
    """Return the parameters of each stage of a film, by its name."""
    refs = tuple(f"frame/{digest_bytes('test', str(number).encode())}" for number in range(12))
    leaves = SequenceLeaves(
        name="toy",
        shape=(96, 128),
        frames=refs,
        annotation=refs[0],
        motion_weights=refs[0],
        weights={"depth-anything-3-base": refs[0]},
        bars=bars,
    )
    graph = SequenceGraph(leaves, PipelineConfig.model_validate(values))
    graph.score(Variant.FUSED)
    return {recipe.task: recipe.params for recipe in graph.recipes.values()}


@pytest.mark.parametrize(
    ("values", "read"),
    [
        (
            {"proposal_source": "tracks"},
            {"dense_tracks", "rigidity", "track_surfaces", "track_objects", "object_points"},
        ),
        ({"proposal_source": "tracks", "cameras": {"method": "depth-anything-3"}}, {"cameras"}),
        ({"proposal_source": "saliency", "rigid_support": {"use": "always"}}, {"rigid_support"}),
    ],
)
def test_recipes_name_the_bars_only_where_there_are_any(values, read):
    with_bars, without = _recipes(BARS, **values), _recipes(None, **values)
    assert read <= {task for task, params in with_bars.items() if "bars" in params}
    assert not any("bars" in params for params in without.values())


@pytest.mark.parametrize("stage", ["track_surfaces", "track_objects"])
def test_a_stage_is_told_the_size_of_the_picture(stage):
    shapes = [_recipes(bars, proposal_source="tracks")[stage]["shape"] for bars in (BARS, None)]
    assert shapes == [[96 - 52 - 17, 128 - 36], [96, 128]]
