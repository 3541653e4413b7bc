"""The graph of pipelines with networks: the weights and parameters that each key depends on."""

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.presets import PRESETS
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.needed_weights import needed_items
from moseg.workflows.stages.registry import find_stage

AFTER_PROPOSALS = {"linking", "tracks", "fundamental", "fundamental_residual", "flow_model", "flow_residual"}
GROUPS = {"affinity", "clustering", "segmentation"}
FIRST_FRAME = ["tags", "detections", "instances", "seeds", "proposals"]
BEHIND_FLOW = {"flow", "flow_model", "flow_residual"} | GROUPS
BEHIND_DEPTH = {"depth", "flow_model", "flow_residual"} | GROUPS
BEHIND_TRACKS = {"tracks", "fundamental", "fundamental_residual"} | GROUPS
GOLDEN = {
    "paper": "5ad11830f9110c03",
    "modern": "9ca4c3a3fa6bff03",
}


def _ref(task, text):
    return f"{task}/{digest_bytes('test', text.encode())}"


def _config(preset, **changes):
    values = {**PRESETS[preset], "sections": {"length": 4, "overlap": 2}, "fundamental": {"gap": 2}}
    for name, value in changes.items():
        stage, _, field = name.partition("__")
        values[stage] = {**values.get(stage, {}), field: value} if field else value
    return PipelineConfig.model_validate(values)


def _graph(config, num_frames=9, changed=None):
    """Return the fused variant's graph, in which the item `changed` has other weights."""
    weights = {name: _ref("weights", name + "*" * (name == changed)) for name in needed_items(config)}
    frames = tuple(_ref("frame", str(number)) for number in range(num_frames))
    graph = SequenceGraph(
        SequenceLeaves("toy", (48, 64), frames, motion_weights=_ref("motion_weights", ""), weights=weights), config
    )
    graph.segmentations(Variant.FUSED)
    return graph


def _tasks(refs):
    return {ref.partition("/")[0] for ref in refs}


@pytest.mark.parametrize("preset", ["paper", "modern"])
@pytest.mark.parametrize(
    ("stage", "moved"),
    [
        ("tags", {*FIRST_FRAME} | AFTER_PROPOSALS | GROUPS),
        ("detections", {*FIRST_FRAME[1:]} | AFTER_PROPOSALS | GROUPS),
        ("flow", BEHIND_FLOW),
        ("depth", BEHIND_DEPTH),
        ("tracks", BEHIND_TRACKS),
    ],
)
def test_other_weights_recompute_their_stage_and_those_downstream(preset, stage, moved):
    config = _config(preset)
    before = _graph(config)
    read = [recipe.inputs["weights"] for recipe in before.recipes.values() if recipe.task == stage]
    (item,) = {name for name, ref in before.leaves.weights.items() if ref in read}
    after = _graph(config, changed=item)
    assert _tasks(after.recipes.keys() - before.recipes.keys()) == moved


def test_weights_of_trackers_and_masks_change_only_the_keys_of_their_stages():
    config = _config("paper")
    before = _graph(config)
    for item, first in (("sam-hq-vit-large", "instances"), (config.deaot.weights, "proposals")):
        moved = {*FIRST_FRAME[FIRST_FRAME.index(first) :]} | AFTER_PROPOSALS | GROUPS
        # A section starts from the objects that were tracked through the one before.
        assert _tasks(_graph(config, changed=item).recipes.keys() - before.recipes.keys()) == moved | {"seeds"}


@pytest.mark.parametrize(
    ("change", "moved"),
    [
        ({"raft__iterations": 7}, BEHIND_FLOW),
        ({"dpt_dinov2__nearest": 0.5}, BEHIND_DEPTH),
        ({"pips__iterations": 3}, BEHIND_TRACKS),
        ({"tracks__window": 21}, set()),
        ({"tracks__border": 9}, BEHIND_TRACKS),
        ({"flow__preset": "fast"}, set()),
        ({"sam2__memory_reach": 3}, set()),
        ({"sam2__boxes_per_pass": 3}, set()),
        ({"ram__max_tags": 5}, {*FIRST_FRAME} | AFTER_PROPOSALS | GROUPS),
        ({"instances__max_area": 0.5}, {"instances", "seeds", "proposals"} | AFTER_PROPOSALS | GROUPS),
    ],
)
def test_parameters_of_a_network_change_the_keys_of_its_results_and_no_others(change, moved):
    before, after = _graph(_config("paper")), _graph(_config("paper", **change))
    assert _tasks(after.recipes.keys() - before.recipes.keys()) == moved


def test_with_given_tags_no_frame_is_tagged():
    graph = _graph(_config("paper", detections__tags="car, person"))
    tasks = [recipe.task for recipe in graph.recipes.values()]
    assert "tags" not in tasks and "ram" not in graph.leaves.weights
    assert all(
        recipe.params["tags"] == ["car", "person"] for recipe in graph.recipes.values() if recipe.task == "detections"
    )


def test_only_the_first_frame_of_a_section_is_proposed_anew():
    graph = _graph(_config("paper"))
    seen = [recipe.inputs["frame"] for recipe in graph.recipes.values() if recipe.task == "detections"]
    assert seen == [graph.leaves.frames[index] for index in (0, 4, 8)]


def test_a_section_is_tracked_into_the_first_frame_of_the_next():
    graph = _graph(_config("paper"))
    tracked = [recipe.inputs["frames"] for recipe in graph.recipes.values() if recipe.task == "proposals"]
    frames = graph.leaves.frames
    assert tracked == [frames[0:5], frames[4:9], frames[8:9]]


def test_a_long_video_does_not_run_out_of_recursion():
    graph = _graph(_config("paper", sections={"length": 1}), num_frames=700)
    assert sum(recipe.task == "seeds" for recipe in graph.recipes.values()) == 700


@pytest.mark.parametrize("preset", ["paper", "modern"])
def test_every_node_is_a_task_and_its_inputs_nodes_or_leaves(preset):
    graph = _graph(_config(preset))
    leaves = {*graph.leaves.frames, *graph.leaves.weights.values()}
    for recipe in graph.recipes.values():
        assert set(recipe.input_refs()) <= graph.recipes.keys() | leaves
        stage = find_stage(recipe.task)
        assert stage.task(recipe.params["method"]).version == recipe.version
        assert set(recipe.inputs) <= set(stage.inputs)


def test_presets_read_the_weights_of_their_networks_only():
    assert needed_items(PipelineConfig()) == {}
    for preset in ("paper", "modern"):
        graph = _graph(_config(preset))
        read = {recipe.inputs["weights"] for recipe in graph.recipes.values() if "weights" in recipe.inputs}
        assert read == set(graph.leaves.weights.values())


def test_any_combination_of_backends_makes_a_graph():
    for depth in ("none", "dpt-dinov2", "depth-anything-v2", "depth-anything-3"):
        for tracks in ("lucas-kanade", "pips", "bootstapir"):
            for source in ("saliency", "detections"):
                config = _config("weights-free", depth__method=depth, tracks__method=tracks, proposal_source=source)
                assert _graph(config).segmentations(Variant.FUSED)


def test_keys_are_golden():
    """Keys change with the content of a recipe, a default or a version; every store then computes the nodes anew."""
    found = {}
    for preset in ("paper", "modern"):
        (*_, last) = _graph(_config(preset)).segmentations(Variant.FUSED)
        found[preset] = last.partition("/")[2][:16]
    assert found == GOLDEN


def test_sam2_reads_only_its_parameters_for_boxes_or_for_tracking():
    before = _graph(_config("modern"))
    moved = {
        name: _tasks(_graph(_config("modern", **{f"sam2__{name}": 3})).recipes.keys() - before.recipes.keys())
        for name in ("boxes_per_pass", "memory_reach")
    }
    assert "instances" in moved["boxes_per_pass"]
    assert "proposals" in moved["memory_reach"] and "instances" not in moved["memory_reach"]
