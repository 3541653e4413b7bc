"""Rigid support of objects: the sections that are compared with a rigid scene, its recipes, and whole runs."""

import json

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import open_store
from moseg.tasks.synthetic import render_scene
from moseg.tasks.synthetic.scenes_still import BRIGHT_SKY
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.clustering import MOTION_GROUPS
from moseg.workflows.stages.rigid_support import BY_MASKS, BY_TRACKS

ALONE = (Variant.OC_DEPTH, Variant.OC, Variant.TRAJS, Variant.BASE)


def _refs(task, count):
    return tuple(f"{task}/{digest_bytes('test', f'{task} {number}'.encode())}" for number in range(count))


def _choice(section, source="saliency", shows_depth=True, gain=0.0):
    """Return the choice of a stretch that is one section of eight frames."""
    first = 8 * section
    return StretchChoice(
        first_frame=first,
        last_frame=first + 7,
        proposals=source,
        reason="",
        moving=0,
        gain=gain,
        inside=0,
        wander_deg=0,
        shows_depth=shows_depth,
    )


def _graph(*choices, num_frames=24, **values):
    given = {"masks": _refs("given_masks", 1)[0], "annotation": _refs("annotation", 1)[0], "num_motions": 2}
    leaves = SequenceLeaves(
        "toy",
        (48, 64),
        _refs("frame", num_frames),
        motion_weights=_refs("motion_weights", 1)[0],
        choices=choices,
        **given,
    )
    config = {"sections": {"length": 8, "overlap": 2}, "track_window": {"min_frames": 10}} | values
    return SequenceGraph(leaves, PipelineConfig.model_validate(config))


def _supports(graph, variant=Variant.FUSED):
    """Return the recipes of rigid support that a variant's motion groups read."""
    clustering = graph.recipes[graph.clustering(variant)]
    return [graph.recipes[ref] for ref in clustering.inputs.get("rigid_support", ())]


def _methods(graph):
    return [(recipe.params["section"], recipe.params["method"]) for recipe in _supports(graph)]


DEEP = [_choice(0), _choice(1), _choice(2)]


def test_sections_are_compared_where_depth_shows_by_parallax_and_where_objects_are_of_tracks():
    graph = _graph(_choice(0), _choice(1, shows_depth=False), _choice(2, "tracks", shows_depth=False))
    assert _methods(graph) == [(0, "masks"), (2, "tracks")]
    assert _supports(_graph(*[_choice(section, shows_depth=False) for section in range(3)])) == []


@pytest.mark.parametrize("source", ["saliency", "groundtruth", "folder"])
def test_objects_of_a_source_that_was_named_are_compared_only_on_demand(source):
    assert _supports(_graph(proposal_source=source)) == []
    assert _supports(_graph(proposal_source=source, rigid_support={"use": "never"})) == []
    compared = _methods(_graph(proposal_source=source, rigid_support={"use": "always"}))
    assert compared == [(section, "masks") for section in range(3)]


def test_objects_of_tracks_are_compared_unless_it_is_switched_off():
    whole = [(section, "tracks") for section in range(3)]
    assert _methods(_graph(proposal_source="tracks")) == whole
    assert _methods(_graph(proposal_source="tracks", rigid_support={"use": "always"})) == whole
    assert _supports(_graph(proposal_source="tracks", rigid_support={"use": "never"})) == []


@pytest.mark.parametrize(
    ("gain", "asked"),
    [
        # Little parallax is enough only for a camera that moves ahead.
        (0.1, "min_ahead_gain"),
        (0.3, "min_gain"),
    ],
)
def test_depth_must_show_around_the_objects_as_it_had_to_show_with_them(gain, asked):
    scene = PipelineConfig().scene_parallax
    (support,) = _supports(_graph(_choice(1, gain=gain)))
    assert support.params["min_gain"] == getattr(scene, asked)
    always = _supports(_graph(_choice(1, gain=gain), rigid_support={"use": "always"}))
    assert [recipe.params["min_gain"] for recipe in always] == [0, 0, 0]


def test_objects_that_moving_tracks_prompt_need_the_depth_of_a_drive():
    graph = _graph(_choice(1, "tracks", gain=0.3))
    assert graph.objects.min_gain(1) == PipelineConfig().scene_parallax.min_ahead_gain


def test_no_section_is_compared_without_a_choice():
    assert _supports(_graph()) == []
    assert _methods(_graph(_choice(1))) == [(1, "masks")]


def test_only_the_fused_variant_compares_objects_with_a_rigid_scene():
    for values in ({"rigid_support": {"use": "always"}}, {"proposal_source": "tracks"}):
        for variant in ALONE:
            graph = _graph(*DEEP, **values)
            graph.score(variant)
            assert "rigid_support" not in {recipe.task for recipe in graph.recipes.values()}
        assert len(_supports(_graph(*DEEP, **values))) == 3


def test_the_backgrounds_group_is_static_where_that_is_chosen():
    assert _supports(_graph(*DEEP, clustering={"static": "group"})) == []
    assert len(_supports(_graph(*DEEP, clustering={"static": "agreement"}))) == 3


@pytest.mark.parametrize("source", ["auto", "saliency"])
def test_a_clustering_without_rigid_support_has_the_recipe_that_it_had_before(source):
    graph = _graph(proposal_source=source)
    recipe = graph.recipes[graph.clustering(Variant.FUSED)]
    expected = MOTION_GROUPS.params(PipelineConfig(), num_views=2, num_motions=None)
    assert recipe.params == {"method": "motion-groups", **expected}
    assert recipe.inputs.keys() == {"affinities"}


@pytest.mark.parametrize("motions", ["auto", "gt", 3])
def test_with_a_number_of_motions_the_threshold_of_static_objects_is_read_too(motions):
    values = {"clustering": {"motions": motions}}
    compared, other = _graph(*DEEP, **values), _graph(**values)
    params = [graph.recipes[graph.clustering(Variant.FUSED)].params for graph in (compared, other)]
    assert params[0]["num_motions"] == params[1]["num_motions"] == {"auto": None, "gt": 2, 3: 3}[motions]
    assert "threshold" in params[0]["clustering"]
    assert ("threshold" in params[1]["clustering"]) == (motions == "auto")


def test_the_comparison_reads_the_tracks_of_the_sections_window():
    graph = _graph(*DEEP, num_frames=24)
    window, step = graph.objects.track_proposals, PipelineConfig().rigid_support.step
    for index, recipe in enumerate(_supports(graph)):
        assert recipe.inputs == {
            "proposals": graph.objects.proposals(index),
            "linking": graph.objects.linking(),
            "dense_tracks": window.dense_tracks(index, step),
            "rigidity": window.rigidity(index, step),
        }
        assert recipe.params["start"] == window.first_row(index)
    # The window of the last section begins before it.
    assert _supports(graph)[2].params["start"] == 2


def test_objects_of_dense_tracks_are_compared_in_all_pairs_whatever_the_step_of_other_objects():
    recipes = [_graph(rigid_support={"step": step}).objects.track_proposals.rigidity(0) for step in (1, 3)]
    assert recipes[0] == recipes[1]
    graph = _graph(*DEEP, rigid_support={"step": 3})
    assert {graph.recipes[recipe.inputs["rigidity"]].params["step"] for recipe in _supports(graph)} == {3}


def test_frames_between_pairs_are_tracked_only_if_pairs_reach_over_them():
    gap = max(PipelineConfig().rigidity.gaps)
    window = _graph(*DEEP).objects.track_proposals
    assert window.dense_tracks(0, gap) == window.dense_tracks(0)
    assert window.dense_tracks(0, gap + 1) != window.dense_tracks(0)


def test_where_objects_are_compared_is_in_no_key_of_what_they_are_compared_with():
    always = _graph(*DEEP, rigid_support={"use": "always"})
    assert [recipe.inputs for recipe in _supports(always)] == [recipe.inputs for recipe in _supports(_graph(*DEEP))]


@pytest.mark.parametrize(
    "changes",
    [
        {"rigid_support": {"max_test": 0.9}},
        {"rigid_support": {"min_attached": 0.5}},
        {"track_objects": {"sensitivity": 2.0}},
    ],
)
def test_what_decides_about_objects_changes_the_support_and_what_follows(changes):
    before, after = _graph(*DEEP), _graph(*DEEP, **changes)
    before.score(Variant.FUSED)
    after.score(Variant.FUSED)
    changed = {ref.partition("/")[0] for ref in after.recipes.keys() - before.recipes.keys()}
    assert changed == {"rigid_support", "clustering", "segmentation", "score"}


class _Artifact(dict):
    @property
    def attributes(self):
        return self

    def array(self, name):
        return self[name]

    cached = array


class _Inputs(dict):
    def __getitem__(self, role):
        return _Artifact(super().__getitem__(role))


def _masked(left=1, right=2):
    """Return the inputs of section 1, which begins in row 2 of its window: objects 1 and 2 lie left and right.

    They are objects 3 and 1 of the sequence. Before the section their tracks are elsewhere or hidden, with other tests.
    """
    rows, columns = np.mgrid[5:60:6, 2:78:6].reshape(2, -1)
    here = np.stack([columns, rows], axis=1).astype(np.float32)
    points = np.stack([here[:, ::-1], here[:, ::-1], *[here] * 5], axis=1)
    masks = np.zeros((5, 64, 80), np.uint16)
    masks[:, 20:40, 10:30], masks[:, 20:40, 50:70] = left, right
    pairs = np.array([(first, 2) for first in range(5)], np.int32)
    test = np.tile(np.where(columns < 40, 1.5, 0.0), (5, 1)).astype(np.float16)
    test[:2] = 3.0
    visible = np.ones(points.shape[:2], bool)
    visible[:, 0] = False
    camera = {"rotation": np.eye(3).tolist(), "translation": [-1.0, 0.0, 0.0]}
    return _Inputs(
        proposals={"masks": masks},
        linking={"identity": np.array([[0, 1, 2], [0, 3, 1]], np.uint16), "num_objects": 4},
        dense_tracks={"points": points, "visible": visible},
        rigidity={"pairs": pairs, "strict_test": test, "focal": 0.8, "cameras": [camera] * 5},
    )


def _compute(task, inputs, **place):
    output = task.run(task.params(PipelineConfig(), **place), inputs, np.random.default_rng(0))
    json.dumps(output.attributes, allow_nan=False)
    return output.arrays["support"], output.attributes


def test_masks_are_compared_in_the_frames_of_their_section_by_the_objects_of_the_sequence():
    support, attributes = _compute(BY_MASKS, _masked(), section=1, start=2, min_gain=0.0)
    # Object 2 is not in the section.
    np.testing.assert_array_equal(support, [1, 1, np.nan, 0])
    # Nine tracks, in each of three pairs.
    assert attributes["num_observations"][2:] == [0, 27]
    assert attributes["test"][1] == 0 and attributes["test"][3] == 1.5


def test_a_proposal_without_pixels_is_static_and_one_of_another_section_is_open():
    support, _ = _compute(BY_MASKS, _masked(left=2), section=1, start=2, min_gain=0.0)
    np.testing.assert_array_equal(support, [1, 0, np.nan, 1])


def test_without_depth_around_them_masks_that_a_rigid_scene_explains_are_open():
    support, attributes = _compute(BY_MASKS, _masked(), section=1, start=2, min_gain=0.05)
    assert attributes["gain"] == 0
    np.testing.assert_array_equal(support, [1, np.nan, np.nan, 0])


def test_objects_of_tracks_move_as_their_tracks_say():
    inputs = _Inputs(
        # Of the candidates, some have no pixels.
        proposals={"candidates": [1, 3, 7], "is_moving": [True, False, True]},
        linking={"identity": np.array([[0, 1, 0, 0, 0], [0, 3, 1, 4, 0]], np.uint16), "num_objects": 5},
    )
    support, _ = _compute(BY_TRACKS, inputs, section=1)
    np.testing.assert_array_equal(support, [1, 1, np.nan, 0, 0])


def test_a_section_of_tracks_without_objects_is_static():
    inputs = _Inputs(
        proposals={"candidates": [], "is_moving": []},
        linking={"identity": np.array([[0, 1], [0, 0]], np.uint16), "num_objects": 2},
    )
    np.testing.assert_array_equal(_compute(BY_TRACKS, inputs, section=1)[0], [1, np.nan])


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    """Return a folder of frames in which nothing moves and a near post hides a wide sky.

    Without the motion network, saliency proposes objects there.
    """
    folder = tmp_path_factory.mktemp("walk") / "frames"
    folder.mkdir()
    for number, image in enumerate(render_scene(BRIGHT_SKY.model_copy(update={"num_frames": 8})).images):
        Image.fromarray(image).save(folder / f"{number:05}.png")
    return folder


@pytest.fixture(scope="module")
def segment_walk(walk, tmp_path_factory):
    """Return a function that segments the walk without the motion network, with some options.

    It returns the objects, the page and the store.
    """
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("segmented")

    def call(*options):
        store, out, page = (folder / name for name in ("store", "out", "page.html"))
        arguments = ("segment", walk, "--store", store, "--out", out, "--report", page, "--quiet")
        options = ("--set", "motion_network.use=never", *options)
        assert run([str(each) for each in (*arguments, *options)]) == 0
        objects = json.loads((out / "motion.json").read_text())["objects"]
        return objects, page.read_text(encoding="utf-8"), open_store(str(store), create=False)

    return call


def test_saliencys_false_objects_are_dropped_by_fused_alone(segment_walk):
    found, page, store = segment_walk()
    assert found == []
    assert "(a rigid scene explains it)" in page and "objects that a rigid scene explains, and of those" in page
    (ref,) = store.refs("rigid_support")
    support = store.read(ref, "support")
    assert len(support) > 1 and (support == 1).all()
    assert len(store.attributes(ref)["num_observations"]) == len(support)
    assert segment_walk("--variant", "base")[0]
    kept, page, _ = segment_walk("--set", "rigid_support.use=never")
    assert kept and "rigid scene explains it)" not in page
    assert segment_walk("--motions", "2")[0] == []


def test_a_result_in_python_says_that_no_rigid_scene_explains_an_object(walk, tmp_path):
    import moseg

    images = [np.array(Image.open(path)) for path in sorted(walk.iterdir())]
    # No object is explained by a rigid scene if every test is too large.
    config = {"rigid_support.max_test": -1.0, "rigid_support.min_observations": 1, "motion_network.use": "never"}
    result = moseg.segment_video(images, config, store=tmp_path / "store", fps=10, progress=False)
    assert result.objects
    judged = [each for each in result.objects if "rigid" in each.static_support]
    assert judged and all(each.static_support["rigid"] == 0 and each.score == 1 for each in judged)
    other = config | {"rigid_support.use": "never"}
    result = moseg.segment_video(images, other, store=tmp_path / "store", fps=10, progress=False)
    assert result.objects and not any("rigid" in each.static_support for each in result.objects)
