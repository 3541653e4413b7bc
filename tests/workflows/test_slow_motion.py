"""Slow motion: pictures several apart that are compared, the recipes that read them, and whole runs."""

import re
from collections import defaultdict

import cv2
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.store import open_store
from moseg.workflows.graph import SequenceGraph, SequenceLeaves, SlowMotionGaps, make_graph
from moseg.workflows.graph.pictures import Pictures
from moseg.workflows.pipelines.video_clips import cue_config

NUM_FRAMES = 40
REFS = {
    role: f"{task}/{digest_bytes('test', task.encode())}"
    for role, task in {"annotation": "annotation", "motion_weights": "motion_weights"}.items()
}


def _frames(numbers):
    return tuple(f"frame/{digest_bytes('test', str(number).encode())}" for number in numbers)


def _leaves(numbers=range(NUM_FRAMES), **given):
    return SequenceLeaves("toy", (48, 64), _frames(numbers), num_motions=2, **REFS, **given)


def _config(**values):
    return PipelineConfig.model_validate({"sections": {"length": 10, "overlap": 3}} | values)


def _graph(gaps=(), **values):
    graph = SequenceGraph(_leaves(gaps=gaps), _config(proposal_source="saliency", **values))
    graph.score(Variant.FUSED)
    graph.moves_now(Variant.FUSED)
    graph.cues()
    return graph


def _written(graph, task):
    return [recipe for recipe in graph.recipes.values() if recipe.task == task]


def test_a_frame_is_compared_with_the_pictures_so_far_away():
    pictures = Pictures(_frames("abbcde"), gaps=(2,) * 6)
    assert [pictures.next(frame) for frame in range(6)] == [3, 4, 4, 5, None, None]
    assert [pictures.previous(frame) for frame in range(6)] == [None, None, None, 0, 2, 3]
    assert list(pictures.followed) == [0, 1, 2, 3]


@pytest.mark.parametrize("gaps", [(3,) * 40, (4,) * 20 + (1,) * 20, (1,) * 20 + (4,) * 20])
@pytest.mark.parametrize(
    "numbers", [[*range(40)], [*range(21)] + [20] * 19, [0] * 20 + [*range(20)]], ids=["plain", "end", "start"]
)
@pytest.mark.parametrize("length", [1, 7, 40])
def test_frames_without_a_neighbour_are_those_at_the_ends(gaps, numbers, length):
    pictures = Pictures(_frames(numbers), gaps=gaps)
    for start in range(0, 40, length):
        stop = min(start + length, 40)
        place = pictures.ends_in(start, stop)
        for t, frame in enumerate(range(start, stop), place["start"]):
            assert (t > 0) == (pictures.previous(frame) is not None)
            assert (t + 1 < place["num_frames"]) == (pictures.next(frame) is not None)
    assert [frame for frame in range(40) if pictures.next(frame) is not None] == list(pictures.followed)


def test_no_frame_lacks_both_neighbours():
    pictures = Pictures(_frames(range(64)), gaps=(8,) * 64)
    assert all(pictures.next(frame) or pictures.previous(frame) is not None for frame in range(64))


def test_a_video_without_slow_motion_has_none_of_it_in_its_keys():
    assert _graph((1,) * NUM_FRAMES).recipes.keys() == _graph().recipes.keys()


def test_what_is_carried_goes_from_frame_to_frame_by_a_share_of_the_flow():
    graph = _graph((4,) * NUM_FRAMES)
    cues = graph.frame_cues
    assert cues.flow_to_next(3) == cues.flow(3, 7)
    assert cues.saliency(20) != cues.steps(20)
    assert graph.recipes[cues.saliency(20)].inputs["previous"] == graph.leaves.frames[16]
    params = graph.recipes[cues.steps(20)].params
    assert (params["previous"], params["next"]) == (0.25, 0.25)
    saliency = [cues.saliency(frame) for frame in range(NUM_FRAMES)]
    steps = [cues.steps(frame) for frame in range(NUM_FRAMES)]
    for task, known in (("accumulation", steps), ("coherence", steps), ("own_motion", saliency)):
        assert all(set(recipe.inputs["saliency"]) < set(known) for recipe in _written(graph, task))


def test_what_was_seen_is_remembered_over_as_many_more_frames():
    def memories(gaps):
        graph = _graph(gaps)
        accumulated = {recipe.params["accumulation"]["memory"] for recipe in _written(graph, "accumulation")}
        remembered = {recipe.params["motion_memory"]["memory"] for recipe in _written(graph, "motion_memory")}
        return accumulated, {recipe.params["memory"] for recipe in _written(graph, "coherence")}, remembered

    for usual, slow in zip(memories(()), memories((4,) * NUM_FRAMES), strict=True):
        assert [memory**4 for memory in slow] == pytest.approx([*usual], abs=1e-5)


def test_motion_models_and_the_background_read_the_same_pairs():
    graph = _graph((4,) * NUM_FRAMES)
    far = {graph.frame_cues.flow(frame, frame + 4) for frame in range(NUM_FRAMES - 4)}
    assert set(graph.cues()) >= far
    for task, role in (("flow_model", "flow"), ("background", "flows")):
        assert all(set(recipe.inputs[role]) <= far for recipe in _written(graph, task))


@pytest.mark.parametrize(("overlap", "gap"), [(3, 3), (8, 8), (12, 12), (20, 12)])
def test_tracks_are_compared_as_far_apart_as_objects_are_known(overlap, gap):
    graph = _graph((4,) * NUM_FRAMES, sections={"length": 20, "overlap": overlap})
    assert PipelineConfig().fundamental.gap == 3
    assert {recipe.params["gap"] for recipe in _written(graph, "fundamental")} == {gap}


def test_a_rigid_scene_is_asked_over_pairs_as_far_apart():
    def gaps(pictures_apart):
        one_section = {"length": NUM_FRAMES, "overlap": 3}
        graph = _graph(pictures_apart, rigid_support={"use": "always"}, sections=one_section)
        names = ("gaps", "test_still_frames", "focal_gap", "pose_reach")
        (params,) = {str([recipe.params[name] for name in names]) for recipe in _written(graph, "rigidity")}
        return params

    def times(factor):
        default = PipelineConfig().rigidity
        lists = [[factor * gap for gap in values] for values in (default.gaps, default.test_still_frames)]
        return str([*lists, factor * default.focal_gap, factor * default.pose_reach])

    assert gaps((2,) * NUM_FRAMES) == times(2)
    assert gaps(()) == times(1)
    # Half of the window's frames begin a pair.
    assert gaps((8,) * NUM_FRAMES) == gaps((NUM_FRAMES // 8,) * NUM_FRAMES)


def test_cameras_by_a_network_are_those_of_the_usual_pairs():
    values = {"rigid_support": {"use": "always"}, "cameras": {"method": "depth-anything-3"}}
    leaves = _leaves(gaps=(2,) * NUM_FRAMES, weights=defaultdict(lambda: REFS["motion_weights"]))
    graph = SequenceGraph(leaves, _config(proposal_source="saliency", **values))
    graph.score(Variant.FUSED)
    assert {tuple(recipe.params["gaps"]) for recipe in _written(graph, "rigidity")} == {PipelineConfig().rigidity.gaps}


def test_objects_are_told_apart_by_the_way_of_each_frame():
    (known,) = {recipe.params.get("gap", 1) for recipe in _written(_graph((4,) * NUM_FRAMES), "components")}
    assert known == 4
    assert all("gap" not in recipe.params for recipe in _written(_graph(), "components"))


def test_the_network_sees_only_frames_that_are_compared_with_each_other():
    cues = _graph((8,) * 20 + (1,) * 20).frame_cues
    inputs = [cues._nodes.recipes[cues.motion_network(frame)].inputs for frame in (10, 15, 20, 30)]
    assert [("previous" in each, "next" in each) for each in inputs] == [
        (True, True),
        (True, False),
        (False, True),
        (True, True),
    ]


def test_a_run_of_the_background_has_pairs():
    graph = _graph((4,) * NUM_FRAMES, saliency={"selection_length": 9})
    assert all(len(recipe.inputs["flows"]) > 1 for recipe in _written(graph, "background"))


def test_a_trained_network_sees_motion_from_picture_to_picture():
    assert cue_config(PipelineConfig()).slow_motion.max_gap == 1


@pytest.mark.parametrize("numbers", [[*range(50)] + [49] * 60, [*range(64)] + [63] * 60, [0] * 70 + [*range(60)]])
def test_a_frozen_end_or_start_is_no_stretch_of_its_own(numbers):
    writer, recipes = _search(numbers, motion_network={"use": "never"})
    gaps = writer.gaps([4] * len(recipes))
    assert len(gaps) == len(numbers) and set(gaps) == {4}
    graph = SequenceGraph(_leaves(numbers, gaps=gaps), _config(proposal_source="saliency"))
    graph.score(Variant.FUSED)
    graph.moves_now(Variant.FUSED)
    assert len(graph.cues()) > 10


def test_scenes_are_compared_within_themselves():
    first, second = (3,) * 16, (1,) * 24
    whole = make_graph(_leaves(gaps=first + second, cuts=(16,)), _config(proposal_source="saliency"))
    one, two = (SequenceGraph(leaves, _config(proposal_source="saliency")) for leaves in whole.leaves.scenes())
    assert two.leaves.gaps == () and one.leaves.gaps == first
    assert whole.frame_cues.saliency(15) == one.frame_cues.saliency(15)
    assert whole.frame_cues.saliency(16) == two.frame_cues.saliency(0)
    assert [whole.frame_cues.pictures.gap(frame) for frame in (15, 16)] == [3, 1]
    shares = [whole.frame_cues.pictures.shares(frame) for frame in (15, 16)]
    assert shares == [{"previous": 1 / 3, "next": 1 / 3}, {"previous": 1, "next": 1}]
    assert whole.frame_cues.pictures.shares(39) == two.frame_cues.pictures.shares(23)
    assert whole.leaves._replace(gaps=()).joined(whole.leaves.scenes()).gaps == first + second
    assert _leaves(cuts=(16,)).joined(_leaves(cuts=(16,)).scenes()).gaps == ()


def _search(numbers, **values):
    writer = SlowMotionGaps(_leaves(numbers), _config(**values))
    return writer, [writer.recipes[ref] for ref in writer.refs()]


def test_every_stretch_has_a_distance_of_its_own():
    writer, recipes = _search(range(150))
    assert [len(recipe.inputs["flows"]) for recipe in recipes] == [8, 8]
    assert writer.gaps([2, 1]) == (2,) * 64 + (1,) * 86
    assert writer.gaps([1, 1]) == ()


def test_the_place_of_a_stretch_is_in_no_key():
    (first, second), (_, same) = _search(range(128))[1], _search([*range(200, 264), *range(64, 128)])[1]
    assert second.ref == same.ref != first.ref


@pytest.mark.parametrize(
    "values",
    [{"slow_motion": {"max_gap": 1}}, {"proposal_source": "tracks"}, {"flow": {"method": "folder"}}],
    ids=["off", "tracks", "given-flow"],
)
def test_slow_motion_is_not_looked_for_where_nothing_reads_it(values):
    assert not _search(range(150), **values)[1]


def test_a_short_scene_has_no_room_for_distant_pairs():
    assert not _search(range(15))[1]
    (recipe,) = _search(range(31))[1]
    assert recipe.params["longest"] == 3
    # Frames that repeat are no room.
    assert not _search([number // 3 for number in range(45)])[1]


HEIGHT, WIDTH, SIDE, SPEED = 120, 192, 36, 0.2
"""The square moves by this many px from frame to frame, before a camera that stands."""


@pytest.fixture(scope="module")
def slow_video(tmp_path_factory):
    """Return a folder of frames and masks of a square that moves slowly, with noise, in the layout of a user's data."""
    rng = np.random.default_rng(5)

    def texture(height, width):
        image = cv2.GaussianBlur(rng.integers(0, 256, (height, width, 3)).astype(np.float32), (0, 0), 1.5)
        return 128 + (image - 128) * 2

    backdrop, square = texture(HEIGHT, WIDTH), texture(SIDE, SIDE)
    folder = tmp_path_factory.mktemp("slow") / "square"
    for kind in ("frames", "masks"):
        (folder / kind).mkdir(parents=True)
    for number in range(48):
        shift = np.float32([[1, 0, 60 + SPEED * number], [0, 1, 40]])
        moved = cv2.warpAffine(square, shift, (WIDTH, HEIGHT))
        mask = cv2.warpAffine(np.ones((SIDE, SIDE), np.float32), shift, (WIDTH, HEIGHT))[..., None]
        image = backdrop * (1 - mask) + moved * mask + rng.normal(0, 3, (HEIGHT, WIDTH, 3))
        Image.fromarray(np.clip(image, 0, 255).astype(np.uint8)).save(folder / "frames" / f"{number:05}.png")
        Image.fromarray((mask[..., 0] > 0.5).astype(np.uint8)).save(folder / "masks" / f"{number:05}.png")
    return folder


@pytest.fixture(scope="module")
def evaluated(slow_video, tmp_path_factory):
    """Return the store, and J by the largest distance of pictures that is allowed."""
    import moseg

    store = tmp_path_factory.mktemp("store")
    scores = {}
    for max_gap in (1, 8):
        config = {"slow_motion": {"max_gap": max_gap}}
        report = moseg.evaluate("folder", config, root=slow_video.parent, motions="auto", store=store, progress=False)
        scores[max_gap] = report.rows[0].mean.J
    return store, scores


def test_what_moves_slowly_is_found(evaluated):
    store, scores = evaluated
    assert scores[8] > 80
    assert scores[8] > scores[1] + 20
    (ref,) = open_store(str(store), create=False).refs("slow_motion")
    assert open_store(str(store), create=False).attributes(ref)["gap"] > 3


def test_a_plan_knows_the_distance_that_was_chosen(evaluated, slow_video, moseg):
    options = ("--dataset", "folder", "--root", slow_video.parent, "--motions", "auto")
    planned = moseg("plan", *options, "--store", evaluated[0])
    assert (planned.code, planned.err) == (0, "")
    assert re.search(r"^0 artifacts to compute, \d+ to reuse", planned.out, re.MULTILINE)
