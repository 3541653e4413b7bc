"""Recipes of a video with black bars: what is analysed reads filled frames, and objects are inside the picture."""

import pytest

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.corrections import Corrections
from moseg.schemas.digests import digest_bytes
from moseg.workflows.graph import Repetitions, SequenceLeaves, Stretches, make_graph
from moseg.workflows.graph.black_bars import sample_frames
from moseg.workflows.pipelines.segment import sinks_of

NUM_FRAMES, CUT = 17, 7
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
EDITS = (
    {"paint": {"object": 1, "frame": 2, "strokes": [{"radius": 5, "points": [[60, 20]]}]}},
    {"add": {"object": 9, "frame": 9, "points": [[60, 20]], "by": "region"}},
)


def _ref(task, text):
    return f"{task}/{digest_bytes('test', str(text).encode())}"


class _AnyWeights(dict):
    def __missing__(self, item):
        return _ref("weights", item)


def _leaves(bars=BARS, edits=(), **given):
    frames = tuple(_ref("frame", number) for number in range(NUM_FRAMES))
    weights, masks = _AnyWeights(), _ref("given_masks", 0)
    if edits:
        given |= {"edits": Corrections.model_validate({"edits": list(edits)}).edits, "frame_size": (48, 64)}
    motion = _ref("motion_weights", "")
    return SequenceLeaves(
        "toy", (48, 64), frames, masks=masks, motion_weights=motion, weights=weights, bars=bars, **given
    )


def _graph(leaves, **changes):
    """Return the graph of a run, with the recipes of all that it asks for."""
    config = PipelineConfig.model_validate(CONFIG | changes)
    graph = make_graph(leaves, config)
    sinks_of(graph, config, Variant.FUSED)
    return graph


def _task(ref):
    return ref.partition("/")[0]


@pytest.mark.parametrize("cuts", [(), (CUT,)])
@pytest.mark.parametrize("changes", CHANGES)
def test_with_bars_only_the_filling_and_the_search_for_what_is_filled_read_the_frames_themselves(changes, cuts):
    graph = _graph(_leaves(cuts=cuts, edits=EDITS), **changes)
    readers = {
        recipe.task for recipe in graph.recipes.values() if any(_task(ref) == "frame" for ref in recipe.input_refs())
    }
    assert readers == {"filled_frame", "black_bars", "screen_graphics"}
    filled = [recipe for recipe in graph.recipes.values() if recipe.task == "filled_frame"]
    assert [recipe.inputs["frame"] for recipe in filled] == list(graph.leaves.frames)
    assert all(recipe.params["bars"] == BARS._asdict() for recipe in filled)


def test_what_is_settled_before_the_graph_reads_filled_frames_too():
    config = PipelineConfig.model_validate(CONFIG)
    for writer, write in ((Repetitions, Repetitions.refs), (Stretches, Stretches.choices)):
        made = writer(_leaves(), config)
        refs = write(made)
        assert refs
        for ref in refs:
            frames = made.recipes[ref].inputs["frames"]
            assert {_task(frame) for frame in frames} == {"filled_frame"} and {*frames} <= {*made.recipes}


def test_points_are_followed_inside_the_picture_alone():
    config = PipelineConfig.model_validate(CONFIG)
    stretches = Stretches(_leaves(), config)
    choices = [stretches.recipes[ref] for ref in stretches.choices()]
    graph = _graph(_leaves(), proposal_source="tracks")
    tracks = [recipe for recipe in graph.recipes.values() if recipe.task == "dense_tracks"]
    assert choices and tracks
    assert all(recipe.params["bars"] == BARS._asdict() for recipe in (*choices, *tracks))


@pytest.mark.parametrize("changes", CHANGES)
def test_without_bars_nothing_is_filled_and_nothing_cleared(changes):
    graph = _graph(_leaves(None, EDITS), **changes)
    assert not any(recipe.task == "filled_frame" or "bars" in recipe.params for recipe in graph.recipes.values())


@pytest.mark.parametrize("changes", CHANGES)
def test_every_reader_of_proposals_reads_those_inside_the_picture(changes):
    graph = _graph(_leaves(), **changes)
    recipes = graph.recipes
    read = {
        (recipe.task, recipe.params["method"], ref)
        for recipe in recipes.values()
        for ref in recipe.input_refs()
        if _task(ref) == "proposals"
    }
    assert read
    for task, method, ref in read:
        assert (recipes[ref].params["method"] == "inside") != (task == "proposals" and method == "inside")


def test_another_width_of_the_bars_changes_the_keys():
    first, second = (_graph(_leaves(bars), proposal_source="saliency") for bars in (BARS, BlackBars(left=9, right=10)))
    assert not {*first.segmentations(Variant.FUSED)} & {*second.segmentations(Variant.FUSED)}


def test_what_becomes_of_the_bars_and_how_many_frames_are_read_is_no_parameter_of_the_search():
    (usual, unfilled) = (_graph(_leaves(None), black_bars={"fill": fill}).black_bars() for fill in (True, False))
    assert usual == unfilled
    few = _graph(_leaves(None), black_bars={"num_frames": 3})
    leaves = few.leaves
    assert few.recipes[few.black_bars()].inputs["frames"] == tuple(leaves.frames[number] for number in (0, 8, 16))


def test_of_what_is_painted_only_strokes_in_their_own_frame_may_lie_in_bars():
    graph = _graph(_leaves(edits=EDITS), proposal_source="saliency")
    painted = {index: graph.recipes[ref].params for index in range(5) if (ref := graph.painted(index)) is not None}
    assert painted[0]["bars"] == BARS._asdict()
    assert painted[0]["drawn"] == [2, None] and {*painted[2]["drawn"]} == {None}


@pytest.mark.parametrize("count", [2, 8, 100])
def test_frames_are_sampled_from_the_first_to_the_last(count):
    indices = sample_frames(count, 8)
    assert indices[0] == 0 and indices[-1] == count - 1
    assert len({*indices}) == len(indices) == min(count, 8)
