"""Sources of proposals chosen for stretches of a video: their places, the graph behind them, and their settling."""

import itertools
import json
import re

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.parameters import SceneParallaxParams
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import open_store
from moseg.tasks.synthetic import SCENES, render_scene
from moseg.workflows.graph import SequenceGraph, SequenceLeaves, Stretches
from moseg.workflows.graph.stretches import Stretch, choose_pairs, cut_stretches

PARAMS = SceneParallaxParams()
SETTINGS = ("--set", "sections.length=6", "--set", "scene_parallax.stretch_length=12", "--set", "max_side=284")


def _refs(task, count):
    return tuple(f"{task}/{digest_bytes('test', str(number).encode())}" for number in range(count))


def _choice(first, last, source):
    return StretchChoice(
        first_frame=first,
        last_frame=last,
        proposals=source,
        reason="",
        moving=1,
        gain=0,
        inside=0,
        wander_deg=0,
        shows_depth=False,
    )


def _leaves(*choices, num_frames=60):
    return SequenceLeaves(
        "toy", (48, 64), _refs("frame", num_frames), motion_weights=_refs("motion_weights", 1)[0], choices=choices
    )


def _recipes(leaves, source):
    graph = SequenceGraph(leaves, PipelineConfig(proposal_source=source))
    graph.segmentations(Variant.FUSED)
    return graph.recipes


@pytest.mark.parametrize("num_frames", [2, 9, 64, 95, 96, 200])
def test_stretches_cover_a_video_and_none_is_short(num_frames):
    stretches = cut_stretches(num_frames, 64)
    assert [frame for start, stop in stretches for frame in range(start, stop)] == list(range(num_frames))
    assert all(stop - start < 96 for start, stop in stretches)
    assert len(stretches) == 1 or all(stop - start >= 32 for start, stop in stretches)


@pytest.mark.parametrize("num_frames", [2, 4, 5, 20, 64, 95])
def test_pairs_spread_over_a_stretch(num_frames):
    pairs = choose_pairs(Stretch(7, 7 + num_frames), PARAMS)
    assert {last - first for first, last in pairs} == {min(PARAMS.pair_gap, num_frames - 1)}
    assert (pairs[0][0], pairs[-1][1]) == (7, 6 + num_frames)
    assert len(pairs) <= PARAMS.num_pairs


def test_the_place_of_a_stretch_is_in_no_key():
    config, frames = PipelineConfig(), _refs("frame", 128)
    first, second = Stretches(_leaves(num_frames=128)._replace(frames=frames), config).choices()
    swapped = Stretches(_leaves()._replace(frames=frames[64:] + frames[:64]), config).choices()
    assert swapped == (second, first)


@pytest.mark.parametrize("source", ["saliency", "tracks"])
def test_recipes_are_those_of_the_source_chosen(source):
    chosen = _recipes(_leaves(_choice(0, 59, source)), "auto")
    assert chosen == _recipes(_leaves(), source)


def test_sections_of_a_video_may_have_different_sources():
    recipes = _recipes(_leaves(_choice(0, 29, "saliency"), _choice(30, 59, "tracks")), "auto")
    proposed = [recipe.params["method"] for recipe in recipes.values() if recipe.task == "proposals"]
    assert proposed == ["saliency", "tracks"]
    (linking,) = (recipe for recipe in recipes.values() if recipe.task == "linking")
    assert linking.params["method"] == "overlap"


def test_a_section_without_a_choice_has_saliency():
    graph = SequenceGraph(_leaves(_choice(30, 59, "tracks")), PipelineConfig())
    assert [graph.objects.source_of(index) for index in range(2)] == ["saliency", "tracks"]
    assert graph.objects.uses_saliency


@pytest.fixture(scope="module")
def journey(tmp_path_factory):
    """Return a folder of frames in which the camera first pans and then drives."""
    folder = tmp_path_factory.mktemp("journey") / "frames"
    folder.mkdir()
    names = ("pan", "forward-drive-epipolar-car")
    images = [render_scene(SCENES[name].model_copy(update={"num_frames": 12})).images for name in names]
    for number, image in enumerate(itertools.chain(*images)):
        Image.fromarray(image).save(folder / f"{number:05}.png")
    return folder


def test_a_video_is_segmented_by_both_and_says_so(journey, moseg, tmp_path):
    store = tmp_path / "store"
    page = tmp_path / "report.html"
    command = ("segment", journey, *SETTINGS, "--store", store, "--quiet")
    assert moseg(*command, "--out", tmp_path / "out", "--report", page).code == 0
    summary = json.loads((tmp_path / "out" / "motion.json").read_text())
    assert [each["proposals"] for each in summary["choices"]] == ["saliency", "tracks"]
    assert [each["shows_depth"] for each in summary["choices"]] == [False, True]
    figures = {"moving", "gain", "inside", "wander_deg", "shows_depth"}
    fields = {"first_frame", "last_frame", "proposals", "reason"} | figures
    assert {frozenset(each) for each in summary["choices"]} == {frozenset(fields)}
    told = "tracks for frames 12 to 23 (the camera drives through a scene with depth"
    assert told in page.read_text()
    assert told in " ".join(moseg("status", "latest", "--store", store).out.split())
    opened = open_store(str(store), create=False)
    assert len(list(opened.refs("dense_tracks"))) == 2
    shown = moseg("report", "latest", "--store", store, "--out", tmp_path / "later.html", "--quiet")
    assert (shown.code, told in (tmp_path / "later.html").read_text()) == (0, True)

    # A damaged choice is made again, and nothing else is.
    damaged = next(iter(opened.refs("scene_parallax")))
    stage, key = damaged.split("/")
    (store / "objects" / stage / key[:2] / key / "manifest.json").write_bytes(b"{}")
    labels = [np.array(Image.open(path)) for path in sorted((tmp_path / "out" / "masks").iterdir())]
    assert moseg(*command, "--out", tmp_path / "again").code == 0
    again = [np.array(Image.open(path)) for path in sorted((tmp_path / "again" / "masks").iterdir())]
    np.testing.assert_array_equal(labels, again)
    assert json.loads((tmp_path / "again" / "motion.json").read_text())["choices"] == summary["choices"]
    assert opened.has(damaged)
    assert len(list((store / "quarantine").glob("*/reason.json"))) == 1


def test_a_result_in_python_has_its_choices(evaluated, tmp_path):
    import moseg

    images = sorted((evaluated.root / "squares" / "frames").iterdir())
    result = moseg.segment_video([np.array(Image.open(path)) for path in images], store=tmp_path / "store", fps=10)
    (choice,) = result.choices
    assert (choice.first_frame, choice.last_frame, choice.proposals) == (0, len(images) - 1, "saliency")


def test_results_keep_their_choices_from_collection(evaluated_copy, moseg):
    assert moseg("store", "gc", "--store", evaluated_copy.store, "--grace-hours", "0").code == 0
    assert len(list(open_store(str(evaluated_copy.store), create=False).refs("scene_parallax"))) == 1


def test_a_plan_counts_choices_and_says_where_they_are_open(evaluated_copy, moseg):
    command = ("plan", *(word for word in evaluated_copy.arguments[1:] if word != "--quiet"))
    assert "not chosen yet" not in moseg(*command, "--store", evaluated_copy.store).out
    opened = open_store(str(evaluated_copy.store), create=False)
    opened.remove(next(iter(opened.refs("scene_parallax"))))
    out = moseg(*command, "--store", evaluated_copy.store).out
    assert re.search(r"^1 artifacts to compute", out, re.MULTILINE)
    assert "the proposals of 1 stretch of video are not chosen yet: the rest is counted as if saliency were" in out
