"""The recipes of a sequence's graph, and thus the artifacts that an option recomputes."""

import pytest
from pydantic import TypeAdapter

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.corrections import Edit
from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import InputError
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.workflows.engine.execution import seeded_generator
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.stages.registry import find_stage

OBJECTS = {"sightings", "components", "proposals", "linking", "tracks"}
FOREGROUND = {"motion_memory", "accumulation", "own_motion", "coherence", "appearance", "foreground"} | OBJECTS
CUES = {"flow", "background", "saliency", "motion_network", "consistency"} | FOREGROUND
END = {"clustering", "segmentation", "score"}
TRAJS = {"fundamental", "fundamental_residual"}
FLOW_MODEL = {"flow_model", "flow_residual"}
BEHIND = TRAJS | FLOW_MODEL | {"affinity"} | END


GOLDEN = {
    "fused": "2428fd47f359a850",
    "oc-depth": "0d1e2eb6f204f897",
    "oc": "509936e502176427",
    "trajs": "f2fb4fbaf3572340",
    "base": "338b46b735c34f19",
    "flow": "b5a20f003bb5ae5e",
    "tracks": "64cc82214ba35683",
}


def _refs(task, count):
    return tuple(f"{task}/{digest_bytes('test', str(number).encode())}" for number in range(count))


LEAVES = SequenceLeaves(
    name="toy",
    shape=(48, 64),
    frames=_refs("frame", 9),
    annotation=_refs("annotation", 1)[0],
    num_motions=3,
    masks=_refs("given_masks", 1)[0],
    motion_weights=_refs("motion_weights", 1)[0],
    tracks=_refs("given_tracks", 1)[0],
    depth=_refs("given_depth", 9),
    flow_forward=_refs("given_flow", 8),
    flow_backward=_refs("given_flow", 8),
)


def _config(**changes):
    """Return a configuration with sections of four frames; changes are given as ``stage__name=value``."""
    values = {"sections": {"length": 4, "overlap": 1}, "fundamental": {"gap": 2}}
    for name, value in changes.items():
        stage, _, field = name.partition("__")
        if field:
            values.setdefault(stage, {})[field] = value
        else:
            values[stage] = value
    return PipelineConfig.model_validate(values)


def _recipes(*variants, leaves=LEAVES, **changes):
    graph = SequenceGraph(leaves, _config(**changes))
    for variant in variants or Variant:
        graph.score(variant)
    graph.cues()
    return graph.recipes


def _tasks(refs):
    return {ref.partition("/")[0] for ref in refs}


@pytest.mark.parametrize(
    ("changes", "moved"),
    [
        ({"affinity__scale": 0.7}, {"affinity"} | END),
        ({"affinity__quantile": 0.25}, {"affinity"} | END),
        ({"affinity__method": "ork"}, {"affinity"} | END),
        ({"affinity__ork_threshold": 5}, set()),
        ({"clustering__motions": 4}, END),
        ({"clustering__motions": "gt"}, END),
        ({"fundamental__threshold": 2.0}, TRAJS | {"affinity"} | END),
        ({"fundamental__gap": 3}, TRAJS | {"tracks", "affinity"} | END),
        ({"flow_model__min_pixels": 80}, FLOW_MODEL | {"affinity"} | END),
        ({"tracks__window": 21}, TRAJS | {"tracks", "affinity"} | END),
        ({"linking__min_iou": 0.4}, TRAJS | FLOW_MODEL | {"linking", "affinity"} | END),
        ({"saliency__floor": 0.4}, TRAJS | FLOW_MODEL | CUES - {"flow", "background"} | {"affinity"} | END),
        ({"saliency__gric_noise": 0.3}, TRAJS | FLOW_MODEL | CUES - {"flow"} | {"affinity"} | END),
        ({"accumulation__consistency_absolute": 0.2}, BEHIND | FOREGROUND | {"consistency"}),
        ({"motion_network__share": 0.3}, BEHIND | FOREGROUND),
        ({"motion_network__step": 1}, BEHIND | FOREGROUND | {"motion_network"}),
        ({"fundamental__step": 3}, TRAJS | {"affinity"} | END),
        ({"accumulation__memory": 0.9}, BEHIND | FOREGROUND),
        ({"accumulation__reliability_floor": 0.2}, BEHIND | FOREGROUND),
        ({"own_motion__spread": 0.5}, BEHIND | FOREGROUND - {"accumulation", "motion_memory"}),
        ({"appearance__levels": 12}, BEHIND | OBJECTS | {"appearance", "foreground"}),
        ({"appearance__smoothing": 2.0}, BEHIND | OBJECTS | {"foreground"}),
        ({"foreground__threshold": 0.5}, BEHIND | FOREGROUND),
        ({"foreground__colour_weight": 0.5}, BEHIND | OBJECTS | {"foreground"}),
        ({"components__score_ratio": 0.2}, BEHIND | OBJECTS),
        ({"refinement__radius": 2}, BEHIND | OBJECTS - {"components", "sightings"}),
        ({"flow__preset": "fast"}, TRAJS | FLOW_MODEL | CUES | {"affinity"} | END),
        ({"max_side": 640}, set()),
    ],
)
def test_an_option_changes_the_keys_of_the_stages_that_read_it_and_no_others(changes, moved):
    before, after = _recipes(), _recipes(**changes)
    assert _tasks(after.keys() - before.keys()) == moved


def test_the_threshold_of_ork_changes_the_keys_of_ork():
    before, after = _recipes(affinity__method="ork"), _recipes(affinity__method="ork", affinity__ork_threshold=5)
    assert _tasks(after.keys() - before.keys()) == {"affinity"} | END


@pytest.mark.parametrize("depth", ["none", "groundtruth"])
def test_the_five_variants_share_all_cues(depth):
    together = _recipes(depth__method=depth)
    for variant in Variant:
        alone = _recipes(variant, depth__method=depth)
        assert alone.keys() <= together.keys()
        cues = {ref for ref in alone if ref.partition("/")[0] in CUES}
        assert cues == {ref for ref in together if ref.partition("/")[0] in CUES}


def test_fused_fits_nothing_of_its_own():
    fused = _recipes(Variant.FUSED, fused_flow_model="oc")
    views = _recipes(Variant.TRAJS, Variant.OC)
    assert _tasks(fused.keys() - views.keys()) == END


def test_fused_and_the_flow_model_with_depth_both_follow_the_equation_as_printed():
    printed = {"fused_flow_model": "oc_depth_paper"}
    fused, alone = _recipes(Variant.FUSED, **printed), _recipes(Variant.OC_DEPTH, **printed)
    assert _tasks(alone.keys() - fused.keys()) == END
    assert alone.keys().isdisjoint(_recipes(Variant.OC_DEPTH).keys() - _recipes(Variant.OC).keys())


def test_a_flow_model_of_a_plug_in_without_depth_reads_none(monkeypatch):
    monkeypatch.setitem(FLOW_MODELS, "plain", FLOW_MODELS["oc"]._replace(name="plain"))
    with_depth = _recipes(Variant.FUSED, fused_flow_model="plain", depth__method="groundtruth")
    assert with_depth == _recipes(Variant.FUSED, fused_flow_model="plain")


def test_without_depth_the_flow_models_differ_only_in_name():
    assert _tasks(_recipes(Variant.OC_DEPTH).keys() - _recipes(Variant.OC).keys()) == FLOW_MODEL | {"affinity"} | END


def test_only_flow_models_with_depth_read_depth():
    with_depth = _recipes(Variant.OC, depth__method="groundtruth")
    assert with_depth == _recipes(Variant.OC)
    inputs = {
        ref
        for recipe in _recipes(Variant.OC_DEPTH, depth__method="groundtruth").values()
        for ref in recipe.input_refs()
    }
    # Residuals of the last frame would need the flow to a next one.
    assert set(LEAVES.depth[:-1]) <= inputs


def test_the_name_of_a_sequence_is_in_no_key():
    assert _recipes(leaves=LEAVES._replace(name="other")) == _recipes()


def test_more_frames_reuse_every_node_that_does_not_read_them():
    short = _recipes(leaves=LEAVES._replace(frames=LEAVES.frames[:8]))
    reused = {ref.partition("/")[0] for ref in short.keys() & _recipes().keys()}
    assert {"flow", "saliency", "consistency", "accumulation"} <= reused


def _backgrounds(num_frames, **saliency):
    """Return the reference of each frame's background, and the recipes."""
    graph = SequenceGraph(
        LEAVES._replace(frames=_refs("frame", num_frames)),
        _config(**{f"saliency__{name}": value for name, value in saliency.items()}),
    )
    return [graph.frame_cues.background(frame) for frame in range(num_frames)], graph.recipes


def test_consecutive_frames_share_a_background_and_a_short_last_run_joins_the_one_before():
    backgrounds, recipes = _backgrounds(27, selection_length=10, selection_step=4)
    assert [backgrounds.index(ref) for ref in backgrounds] == [0] * 10 + [10] * 10 + [20] * 7
    assert [len(recipes[backgrounds[frame]].inputs["flows"]) for frame in (0, 10, 20)] == [3, 3, 2]
    assert len(set(_backgrounds(24, selection_length=10)[0])) == 2


def test_more_frames_do_not_change_the_backgrounds_before_them():
    short, _ = _backgrounds(26, selection_length=10, selection_step=4)
    assert _backgrounds(40, selection_length=10, selection_step=4)[0][:20] == short[:20]


def test_layers_need_no_selection_and_a_single_frame_has_no_background():
    assert _backgrounds(9, background="layers")[0] == [None] * 9
    assert _backgrounds(1)[0] == [None]
    assert "background" not in _tasks(_recipes(saliency__background="layers"))


def test_every_input_is_a_leaf_or_a_node():
    for given in (
        {},
        {"proposal_source": "groundtruth", "flow__method": "groundtruth", "tracks__method": "groundtruth"},
    ):
        recipes = _recipes(depth__method="groundtruth", **given)
        leaves = {*LEAVES.frames, LEAVES.annotation, LEAVES.masks, LEAVES.motion_weights, LEAVES.tracks}
        leaves |= {*LEAVES.depth, *LEAVES.flow_forward, *LEAVES.flow_backward}
        for recipe in recipes.values():
            assert set(recipe.input_refs()) <= recipes.keys() | leaves
            stage = find_stage(recipe.task)
            assert stage.task(recipe.params["method"]).version == recipe.version
        assert set(recipe.inputs) <= set(stage.inputs)


def test_given_cues_are_not_estimated():
    given = _recipes(proposal_source="groundtruth", flow__method="groundtruth", tracks__method="groundtruth")
    assert not _tasks(given) & {"flow", "saliency"}


@pytest.mark.parametrize(
    ("missing", "changes"),
    [
        ({"annotation": None}, {}),
        ({"num_motions": None}, {"clustering__motions": "gt"}),
        ({"masks": None}, {"proposal_source": "folder"}),
        ({"depth": None}, {"depth__method": "folder"}),
        ({"flow_forward": None}, {"flow__method": "groundtruth"}),
        ({"tracks": None}, {"tracks__method": "groundtruth"}),
    ],
)
def test_an_error_about_a_missing_cue_names_the_sequence(missing, changes):
    with pytest.raises(InputError, match="sequence toy"):
        _recipes(leaves=LEAVES._replace(**missing), **changes)


def test_two_frames_are_enough():
    tasks = _tasks(_recipes(leaves=LEAVES._replace(frames=LEAVES.frames[:2])))
    assert tasks >= TRAJS | FLOW_MODEL | END


def test_keys_are_golden():
    """Keys change with the content of a recipe, a default or a version; every store then computes the nodes anew."""
    graph = SequenceGraph(LEAVES, _config())
    found = {variant.value: graph.score(variant).partition("/")[2][:16] for variant in Variant}
    found["flow"] = graph.frame_cues.flow(0, 1).partition("/")[2][:16]
    found["tracks"] = graph.motions.tracks(0).partition("/")[2][:16]
    assert found == GOLDEN


def test_a_key_draws_the_same_numbers_everywhere():
    assert seeded_generator("0f" * 32).integers(0, 1000, 4).tolist() == [226, 45, 75, 232]
    assert seeded_generator("0f" * 32).random() != seeded_generator("1f" * 32).random()


EDITS = TypeAdapter(tuple[Edit, ...]).validate_python(
    [{"drop": 1}, {"rename": {"object": 2, "name": "left"}}, {"split": {"object": 2, "frame": 3, "into": 5}}]
)


def _labels(edits=(), variant=Variant.FUSED, **changes):
    graph = SequenceGraph(LEAVES._replace(edits=edits), _config(**changes))
    return graph, graph.segmentations(variant)


@pytest.mark.parametrize("variant", Variant)
def test_edits_add_the_corrected_objects_and_change_no_key_before_them(variant):
    (plain, _), (corrected, labels) = _labels(variant=variant), _labels(EDITS, variant)
    new = {recipe.task: recipe for ref, recipe in corrected.recipes.items() if ref not in plain.recipes}
    assert set(new) == {"corrected_objects", "segmentation"}
    assert {corrected.recipes[ref].params["method"] for ref in labels} == {"corrected"}
    assert new["corrected_objects"].params["steps"] == [
        {"kind": "drop", "objects": [1]},
        {"kind": "split", "objects": [2], "frame": 3, "into": 5},
    ]


def test_names_alone_change_no_key():
    assert _labels(EDITS[1:2])[1] == _labels()[1]


def test_small_objects_are_left_out_without_another_key_before_the_result():
    (plain, _), (changed, _) = _labels(), _labels(moving_objects__min_area=0.1)
    new = {ref.partition("/")[0] for ref in changed.recipes} - {ref.partition("/")[0] for ref in plain.recipes}
    assert new == {"object_areas", "corrected_objects"}
    assert _labels(EDITS, moving_objects__min_area=0.0)[1] == _labels(EDITS)[1]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"affinity__scale": 0.8},
        {"clustering__motions": 2},
        {"moving_objects__min_area": 0.1},
        {"components__min_area": 0.1},
    ],
)
@pytest.mark.parametrize("edits", [(), EDITS])
def test_a_changed_graph_has_the_keys_of_one_that_is_written_anew(changes, edits):
    graph, _ = _labels(affinity__quantile=0.25)
    changed = graph.changed(LEAVES._replace(edits=edits), _config(**changes))
    wanted, labels = _labels(edits, **changes)
    assert changed.segmentations(Variant.FUSED) == labels
    assert changed.moves_now(Variant.FUSED) == wanted.moves_now(Variant.FUSED)
    assert changed.recipes.keys() >= wanted.recipes.keys()


def test_a_graph_that_is_changed_again_and_again_grows_no_further():
    graph, labels = _labels()
    sizes = []
    for index in range(12):
        changes = {"affinity__scale": 0.3 + index / 100} if index % 3 == 0 else {}
        changes["clustering__threshold"] = 0.2 + index / 100
        edits = EDITS[: index % len(EDITS)]
        graph = graph.changed(LEAVES._replace(edits=edits), _config(**changes))
        wanted, _ = _labels(edits, **changes)
        assert graph.segmentations(Variant.FUSED) == wanted.segmentations(Variant.FUSED)
        assert graph.recipes.keys() >= wanted.recipes.keys()
        sizes.append(len(graph.recipes))
    assert max(sizes[6:]) <= max(sizes[:6])
    # What is common to all is where it was.
    assert graph.changed(LEAVES, _config()).segmentations(Variant.FUSED) == labels


@pytest.mark.parametrize("step", [1, 2, 3])
@pytest.mark.parametrize("num_frames", [1, 2, 3, 6, 9, 12])
def test_every_frame_is_one_that_the_motion_network_looks_at_or_beside_one_of_its_section(num_frames, step):
    leaves = LEAVES._replace(frames=_refs("frame", num_frames))
    cues = SequenceGraph(leaves, _config(motion_network__step=step)).frame_cues
    for start in range(0, num_frames, 4):
        stop = min(start + 4, num_frames)
        looked_at = {start + frame for frame in cues.looked_at(start, stop)}
        assert looked_at <= set(range(max(start - 1, 0), min(stop + 1, num_frames)))
        assert all(looked_at & {frame - 1, frame, frame + 1} for frame in range(start, stop))
        assert all(frame % step == 0 or frame == num_frames - 1 for frame in looked_at)


@pytest.mark.parametrize(("num_frames", "expected"), [(9, [0, 4, 8]), (10, [0, 4, 8]), (11, [0, 4, 8, 10])])
def test_the_last_frame_is_looked_at_unless_it_is_beside_another(num_frames, expected):
    config = PipelineConfig.model_validate({"motion_network": {"step": 4}})
    frames = tuple(f"frame/{number:064x}" for number in range(num_frames))
    cues = FrameCues(Nodes(SequenceLeaves("toy", (48, 64), frames), config))
    assert cues.looked_at(0, num_frames) == expected
