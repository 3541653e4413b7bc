"""Recipes of a video of several scenes: those of each scene are those of the scene as a video of its own."""

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.corrections import Corrections
from moseg.schemas.digests import digest_bytes
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.graph import SequenceGraph, SequenceLeaves, make_graph

NUM_FRAMES, CUT = 17, 7
CONFIG = {"sections": {"length": 4, "overlap": 2}, "carrying": {"reach": 3}}
CHANGES = (
    {"proposal_source": "saliency"},
    {"proposal_source": "tracks"},
    {"proposal_source": "saliency", "moving_objects": {"min_area": 0.01}},
    {"proposal_source": "saliency", "clustering": {"auto": "geometric"}},
    {"proposal_source": "saliency", "flow": {"method": "folder"}, "depth": {"method": "folder"}},
)


def _ref(task, text):
    return f"{task}/{digest_bytes('test', str(text).encode())}"


def _config(**changes):
    return PipelineConfig.model_validate(CONFIG | changes)


def _leaves(start=0, stop=NUM_FRAMES, **given):
    def refs(task, last):
        return tuple(_ref(task, number) for number in range(start, last))

    cues = {"depth": refs("given_depth", stop)}
    cues |= {f"flow_{way}": refs(f"given_flow_{way}", stop - 1) for way in ("forward", "backward")}
    return SequenceLeaves(
        "toy", (48, 64), refs("frame", stop), motion_weights=_ref("motion_weights", ""), **cues, **given
    )


def _parts():
    return _leaves(0, CUT), _leaves(CUT, NUM_FRAMES)


def _write(graph):
    """Write all that a run asks for, and return the references of the labels."""
    for write in (graph.moves_now, graph.confidences, graph.clustering):
        write(Variant.FUSED)
    return graph.segmentations(Variant.FUSED)


@pytest.mark.parametrize("changes", CHANGES)
def test_up_to_the_motion_groups_a_scene_has_the_keys_of_its_part(changes):
    config = _config(**changes)
    graph = make_graph(_leaves(cuts=(CUT,)), config)
    _write(graph)
    parts = [SequenceGraph(part, config) for part in _parts()]
    for part in parts:
        _write(part)
        assert {part.objects.linking(), part.clustering(Variant.FUSED)} <= {*graph.recipes}
        own = {recipe.task for ref, recipe in part.recipes.items() if ref not in graph.recipes}
        assert own <= {"segmentation", "moves_now", "confidence", "corrected_objects"}
    of_whole = {recipe.task for ref, recipe in graph.recipes.items() if not any(ref in part.recipes for part in parts)}
    assert of_whole <= {"linking", "clustering", "segmentation", "moves_now", "confidence", "corrected_objects"}


def test_no_recipe_but_that_of_the_groups_reads_frames_of_two_scenes():
    graph = make_graph(_leaves(cuts=(CUT,)), _config(proposal_source="saliency"))
    _write(graph)
    first, second = (set(part.frames) for part in _parts())
    for recipe in graph.recipes.values():
        read = {ref for ref in recipe.input_refs() if ref.startswith("frame/")}
        assert not (read & first and read & second)


def test_sections_begin_anew_with_a_scene():
    graph = make_graph(_leaves(cuts=(CUT,)), _config())
    assert [section[:2] for section in graph.sections] == [(0, 4), (4, 7), (7, 11), (11, 15), (15, 17)]
    assert [graph.place(frame) for frame in (0, 6, 7, 10, 16)] == [(0, 0), (1, 2), (2, 0), (2, 3), (4, 1)]
    assert len(_write(graph)) == len(graph.sections)


def test_a_frame_before_a_cut_is_followed_by_no_picture():
    graph = make_graph(_leaves(cuts=(CUT,)), _config())
    assert [*graph.frame_cues.pictures.followed] == [*range(CUT - 1), *range(CUT, NUM_FRAMES - 1)]


def test_without_cuts_the_graph_is_that_of_a_sequence():
    plain = make_graph(_leaves(), _config())
    assert type(plain) is SequenceGraph and plain.scenes == (plain,)
    off = make_graph(_leaves(), _config(scene_cuts={"apart": False}))
    assert _write(plain) == _write(off) and {*plain.recipes} == {*off.recipes}


def test_what_was_settled_for_scenes_is_kept_in_frames_of_the_video():
    figures = {"proposals": "tracks", "reason": "", "moving": 1, "gain": 1, "inside": 1, "wander_deg": 1}
    choice = StretchChoice(first_frame=0, last_frame=CUT - 1, shows_depth=True, **figures)
    leaves = _leaves(cuts=(CUT,))
    first, second = leaves.scenes()
    settled = first._replace(repetitions=(3,), choices=(choice,)), second._replace(repetitions=(1, 4))
    joined = leaves.joined(settled)
    assert joined.repetitions == (3, CUT + 1, CUT + 4) and joined.choices == (choice,)
    assert joined.scenes() == settled
    moved = leaves.joined((first, second._replace(choices=(choice,))))
    assert (moved.choices[0].first_frame, moved.choices[0].last_frame) == (CUT, 2 * CUT - 1)
    assert moved.scenes()[1].choices == (choice,)


@pytest.mark.parametrize(("frame", "reached"), [(5, {0, 1}), (6, {0, 1}), (7, {2}), (9, {2, 3})])
def test_no_stroke_reaches_over_a_cut(frame, reached):
    stroke = {"object": 9, "frame": frame, "strokes": [{"radius": 5, "points": [[60, 20]]}]}
    edits = Corrections.model_validate({"edits": [{"paint": stroke}]}).edits
    graph = make_graph(_leaves(cuts=(CUT,), edits=edits, frame_size=(96, 128)), _config())
    _write(graph)
    assert {index for index in range(len(graph.sections)) if graph.painted(index)} == reached


def test_a_graph_under_other_settings_has_the_recipes_that_it_has_when_it_is_written_anew():
    leaves, config = _leaves(cuts=(CUT,)), _config()
    graph = make_graph(leaves, config)
    _write(graph)
    changes = {}
    steps = {"affinity": {"scale": 2.0}}, {"clustering": {"threshold": 0.3}}, {"sections": {"length": 5}}
    for step in steps:
        changes |= step
        graph, anew = (write(leaves, _config(**changes)) for write in (graph.changed, make_graph))
        assert _write(graph) == _write(anew) and {*anew.recipes} <= {*graph.recipes}


def test_settings_that_were_tried_leave_no_recipes():
    leaves = _leaves(cuts=(CUT,))
    graph = make_graph(leaves, _config())
    _write(graph)
    sizes = []
    for threshold in (0.2, 0.3, 0.4):
        graph = graph.changed(leaves, _config(clustering={"threshold": threshold}))
        _write(graph)
        sizes.append(len(graph.recipes))
    assert len({*sizes}) == 1
