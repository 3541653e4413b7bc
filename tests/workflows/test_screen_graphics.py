"""Recipes of a video with graphics: what is analysed reads filled frames, and no point is followed in a graphic."""

import pytest

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.workflows.graph import Repetitions, SequenceLeaves, Stretches, make_graph
from moseg.workflows.graph.screen_graphics import read_graphics
from moseg.workflows.pipelines.segment import sinks_of

NUM_FRAMES, CUT = 17, 7
GRAPHICS = ScreenGraphics((((30, 5), (44, 5), (44, 12), (30, 12)),))
OTHER = GRAPHICS.moved(1, 0)
BARS = BlackBars(left=9, right=9)
CONFIG = {"sections": {"length": 4, "overlap": 2}}
CHANGES = (
    {"proposal_source": "saliency"},
    {"proposal_source": "saliency", "video_network": {"use": "always"}},
    {"proposal_source": "saliency", "depth": {"method": "depth-anything-v2"}},
    {"proposal_source": "saliency", "rigid_support": {"use": "always"}},
    {"proposal_source": "tracks"},
    {"proposal_source": "motion-prompts", "detections": {"masks": "sam2", "tracker": "sam2"}},
    {"proposal_source": "detections"},
    {"proposal_source": "sam3", "sam3": {"concepts": "dog"}, "detections": {"tracker": "sam3"}},
    {"proposal_source": "folder"},
)


def _ref(task, text):
    return f"{task}/{digest_bytes('test', str(text).encode())}"


class _AnyWeights(dict):
    def __missing__(self, item):
        return _ref("weights", item)


def _leaves(graphics=GRAPHICS, **given):
    frames = tuple(_ref("frame", number) for number in range(NUM_FRAMES))
    given = {"masks": _ref("given_masks", 0), "motion_weights": _ref("motion_weights", ""), **given}
    return SequenceLeaves("toy", (48, 64), frames, weights=_AnyWeights(), graphics=graphics, **given)


def _graph(leaves, **changes):
    """Return the graph of a run, with the recipes of all that it asks for."""
    config = PipelineConfig.model_validate(CONFIG | changes)
    graph = make_graph(leaves, config)
    sinks_of(graph, config, Variant.FUSED)
    return graph


def _choices(leaves):
    """Return the recipes of the choices that are settled before the graph."""
    stretches = Stretches(leaves, PipelineConfig.model_validate(CONFIG))
    return [stretches.recipes[ref] for ref in stretches.choices()]


def _of_task(graph, task):
    return [recipe for recipe in graph.recipes.values() if recipe.task == task]


def _task(ref):
    return ref.partition("/")[0]


@pytest.mark.parametrize("cuts", [(), (CUT,)])
@pytest.mark.parametrize("bars", [None, BARS])
@pytest.mark.parametrize("changes", CHANGES)
def test_every_frame_that_is_analysed_is_a_filled_one(changes, bars, cuts):
    graph = _graph(_leaves(bars=bars, cuts=cuts), **changes)
    readers = {
        recipe.task for recipe in graph.recipes.values() if any(_task(ref) == "frame" for ref in recipe.input_refs())
    }
    assert readers == {"filled_frame", "black_bars", "screen_graphics"}
    filled = _of_task(graph, "filled_frame")
    assert [recipe.inputs["frame"] for recipe in filled] == list(graph.leaves.frames)
    expected = {"method": "nearest-scene", "graphics": GRAPHICS.as_json()}
    expected |= {} if bars is None else {"bars": bars._asdict()}
    assert all(recipe.params == expected for recipe in filled)


def test_what_is_settled_before_the_graph_reads_filled_frames_too():
    config = PipelineConfig.model_validate(CONFIG)
    for writer, write in ((Repetitions, Repetitions.refs), (Stretches, Stretches.choices)):
        made = writer(_leaves(), config)
        refs = write(made)
        assert refs
        for ref in refs:
            frames = made.recipes[ref].inputs["frames"]
            assert {_task(frame) for frame in frames} == {"filled_frame"} and {*frames} <= {*made.recipes}


@pytest.mark.parametrize("bars", [None, BARS])
def test_points_are_followed_outside_graphics_alone(bars):
    leaves = _leaves(bars=bars)
    choices, tracks = _choices(leaves), _of_task(_graph(leaves, proposal_source="tracks"), "dense_tracks")
    assert choices and tracks
    for recipe in (*choices, *tracks):
        assert recipe.params["graphics"] == GRAPHICS.as_json() and ("bars" in recipe.params) == (bars is not None)


@pytest.mark.parametrize("bars", [None, BARS])
@pytest.mark.parametrize("changes", CHANGES)
def test_without_graphics_no_recipe_has_any(changes, bars):
    leaves = _leaves(None, bars=bars)
    recipes = [*_graph(leaves, **changes).recipes.values(), *_choices(leaves)]
    assert not any("graphics" in recipe.params for recipe in recipes)
    assert all(recipe.params["method"] == "border-replicated" for recipe in recipes if recipe.task == "filled_frame")


def test_without_anything_that_hides_the_scene_nothing_is_filled():
    assert not _of_task(_graph(_leaves(None)), "filled_frame")


def test_another_place_of_graphics_changes_the_keys():
    first, second = (_graph(_leaves(graphics), proposal_source="saliency") for graphics in (GRAPHICS, OTHER))
    assert not {*first.segmentations(Variant.FUSED)} & {*second.segmentations(Variant.FUSED)}


def test_what_is_masked_by_graphics_is_no_proposal_that_is_cleared():
    """Unlike black bars, graphics hide scene that goes on behind them: objects may reach into them."""
    graph = _graph(_leaves(), proposal_source="saliency")
    assert not any(recipe.params["method"] == "inside" for recipe in _of_task(graph, "proposals"))


def test_what_becomes_of_the_graphics_and_how_many_frames_are_read_is_no_parameter_of_the_search():
    usual, unfilled = (_graph(_leaves(None), screen_graphics={"fill": fill}) for fill in (True, False))
    assert usual.screen_graphics() == unfilled.screen_graphics()
    few = _graph(_leaves(None), screen_graphics={"num_frames": 3})
    searched = few.recipes[few.screen_graphics()]
    for role, numbers in (("frames", (0, 8, 15)), ("following", (1, 9, 16))):
        assert searched.inputs[role] == tuple(few.leaves.frames[number] for number in numbers)
    assert not {"fill", "num_frames"} & {*searched.params["screen_graphics"]}
    other = _graph(_leaves(None), screen_graphics={"max_shift": 0.3})
    assert other.screen_graphics() != usual.screen_graphics()


@pytest.mark.parametrize("graphics", [None, GRAPHICS])
def test_the_search_reads_the_black_bars_and_the_frames_as_they_are(graphics):
    graph = _graph(_leaves(graphics))
    inputs = graph.recipes[graph.screen_graphics()].inputs
    assert inputs["bars"] == graph.black_bars()
    assert {*inputs["frames"]} <= {*graph.leaves.frames} and inputs["frames"][0] == graph.leaves.frames[0]


def test_graphics_are_read_as_they_were_written():
    assert read_graphics({"graphics": GRAPHICS.as_json()}) == GRAPHICS
