"""Objects that networks outline and track, prompted by moving regions, on tiny checkpoints."""

import json

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import open_store
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.needed_weights import needed_items

NETWORK = {"detections": {"masks": "sam2", "tracker": "sam2"}, "sections": {"length": 4, "overlap": 2}}


@pytest.fixture
def segment(moseg, tiny, tmp_path, monkeypatch, write_squares):
    """Return a function that runs `moseg segment` with motion prompts on twelve frames of two moving squares."""
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tiny))
    monkeypatch.setenv("MOSEG_OFFLINE", "1")
    video = write_squares(tmp_path / "clip", num_frames=12) / "frames"

    def call(*words):
        out = ("--store", tmp_path / "store", "--out", tmp_path / "out")
        return moseg("segment", video, "--proposals", "motion-prompts", *out, "--section-length", "6", *words)

    return call


def _ref(task, text):
    return f"{task}/{digest_bytes('test', text.encode())}"


def _graph(source, choice="saliency", **changes):
    config = PipelineConfig.model_validate({"proposal_source": source, **NETWORK, **changes})
    frames = tuple(_ref("frame", str(number)) for number in range(9))
    weights = {name: _ref("weights", name) for name in needed_items(config)}
    measured = {"moving": 1.0, "gain": 0.1, "inside": 0.5, "wander_deg": 1.0, "shows_depth": False}
    chosen = StretchChoice(first_frame=0, last_frame=8, proposals=choice, reason="", **measured)
    leaves = SequenceLeaves(
        "toy", (48, 64), frames, motion_weights=_ref("motion_weights", ""), weights=weights, choices=(chosen,)
    )
    graph = SequenceGraph(leaves, config)
    graph.segmentations(Variant.FUSED)
    return graph


def _recipes(graph, task):
    return [recipe for recipe in graph.recipes.values() if recipe.task == task]


@pytest.mark.parametrize("choice", ["saliency", "tracks"])
def test_the_regions_are_the_proposals_of_auto(choice):
    prompts = _recipes(_graph("motion-prompts", choice), "motion_prompts")
    regions = {recipe.inputs["regions"] for recipe in prompts}
    alone = {ref for ref, recipe in _graph("auto", choice).recipes.items() if recipe.task == "proposals"}
    assert regions == alone and regions


def test_each_section_is_tracked_from_its_prompted_objects():
    graph = _graph("motion-prompts")
    instances = _recipes(graph, "instances")
    assert [recipe.params["method"] for recipe in instances] == ["sam2-prompts"] * 3
    assert {recipe.inputs["frame"] for recipe in instances} == {graph.leaves.frames[index] for index in (0, 4, 8)}
    tracked = [recipe for recipe in _recipes(graph, "proposals") if recipe.params["method"] == "sam2"]
    assert len(tracked) == len(_recipes(graph, "seeds")) == 3
    assert not _recipes(graph, "tags") and not _recipes(graph, "detections")


def test_parameters_of_the_choice_leave_the_prompts_as_they_are():
    before, after = (
        {ref for ref, recipe in graph.recipes.items() if recipe.task == "motion_prompts"}
        for graph in (_graph("motion-prompts"), _graph("motion-prompts", motion_prompts={"max_growth": 2.0}))
    )
    assert before == after
    moved = _graph("motion-prompts", motion_prompts={"num_points": 2})
    assert before.isdisjoint(moved.recipes)


def test_the_weights_are_those_of_masks_and_tracker_alone():
    config = PipelineConfig.model_validate({"proposal_source": "motion-prompts", **NETWORK})
    assert needed_items(config) == {"sam2.1-hiera-large": "sam2"}


def test_squares_are_prompted_outlined_and_tracked(segment, tmp_path):
    ran = segment("--set", "motion_prompts.min_coverage=0", "--set", "motion_prompts.max_growth=1000")
    assert ran.code == 0, ran.err
    store = open_store(str(tmp_path / "store"))
    places = sorted((tmp_path / "store" / "objects" / "motion_prompts").glob("*/*"))
    assert len(places) == 2
    for place in places:
        ref = f"motion_prompts/{place.name}"
        labels, points = store.read(ref, "labels"), store.read(ref, "points")
        assert len(points) >= 1
        for number, (left, top, right, bottom) in enumerate(store.read(ref, "boxes"), start=1):
            rows, columns = np.nonzero(labels == number)
            assert left <= np.median(columns) <= right and top <= np.median(rows) <= bottom
    masks = sorted((tmp_path / "out" / "masks").glob("*.png"))
    assert len(masks) == 12
    with Image.open(masks[0]) as image:
        assert image.size == (128, 96)
    assert json.loads((tmp_path / "out" / "motion.json").read_text())["num_frames"] == 12
    again = segment("--set", "motion_prompts.min_coverage=0", "--set", "motion_prompts.max_growth=1000")
    assert "(0 artifacts computed" in again.out


@pytest.mark.parametrize("preset", ["weights-free", "paper", "modern"])
def test_masks_and_tracker_are_sam2_unless_the_user_chooses(preset, moseg):
    shown = moseg("config", "dump", "--preset", preset, "--proposals", "motion-prompts")
    assert shown.code == 0 and "masks: sam2" in shown.out and "tracker: sam2" in shown.out
    chosen = moseg("config", "dump", "--preset", preset, "--proposals", "motion-prompts", "--tracker", "deaot")
    assert chosen.code == 0 and "masks: sam2" in chosen.out and "tracker: deaot" in chosen.out


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ("--masks", "sam-hq"),
            "a network that takes no points as prompts in --masks; got sam-hq; expected --masks sam2",
        ),
        (("--tags", "car"), "an option of detections in --tags; got proposals motion-prompts"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(words, line, segment):
    ran = segment(*words)
    assert ran.code == 2 and line in ran.err and ran.err.count("\n") == 1
