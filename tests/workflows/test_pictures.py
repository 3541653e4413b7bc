"""Frames that repeat: the pictures that they show, the recipes that read their neighbours, and whole runs."""

import cv2
import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.workflows.graph import SequenceGraph, SequenceLeaves, Stretches
from moseg.workflows.graph.pictures import Pictures

PLAIN = "abcdefghi"
DOUBLED = "".join(2 * letter for letter in PLAIN)
PULLED_DOWN = "aabbbccdddeefffgghhhii"
FROZEN = "aaaaaa" + "bcdefg" + "hhhhhh" + "iiiiii"


def _frames(letters):
    """Return references of frames, equal where letters are."""
    return tuple(f"frame/{digest_bytes('test', letter.encode())}" for letter in letters)


def _leaves(letters, **given):
    refs = {"annotation": "annotation", "motion_weights": "motion_weights"}
    given = {role: f"{task}/{digest_bytes('test', task.encode())}" for role, task in refs.items()} | given
    return SequenceLeaves("toy", (48, 64), _frames(letters), num_motions=2, **given)


def _graph(letters, given=(), **values):
    sections = {"sections": {"length": 6, "overlap": 2}, "fundamental": {"gap": 2}, "proposal_source": "saliency"}
    return SequenceGraph(_leaves(letters, **dict(given)), PipelineConfig.model_validate(sections | values))


def _cues(letters, name, **values):
    """Return the recipe of a cue of every frame."""
    graph = _graph(letters, **values)
    return [graph.recipes[getattr(graph.frame_cues, name)(frame)] for frame in range(len(letters))]


def _written(graph, task, method=None):
    found = (recipe for recipe in graph.recipes.values() if recipe.task == task)
    return [recipe for recipe in found if method in (None, recipe.params["method"])]


def _complete(letters, **values):
    """Return the graph of a whole run."""
    graph = _graph(letters, **values)
    graph.score(Variant.FUSED)
    graph.moves_now(Variant.FUSED)
    graph.cues()
    return graph


def test_equal_frames_in_a_row_are_one_picture():
    pictures = Pictures(_frames("abbbcca"))
    assert [pictures.of(frame) for frame in range(7)] == [0, 1, 1, 1, 2, 2, 3]
    assert [pictures.next(frame) for frame in range(7)] == [1, 4, 4, 4, 6, 6, None]
    assert [pictures.previous(frame) for frame in range(7)] == [None, 0, 0, 0, 3, 3, 5]
    assert [list(pictures.frames(picture)) for picture in range(len(pictures))] == [[0], [1, 2, 3], [4, 5], [6]]
    assert pictures.distinct(2, 7) == [2, 4, 6]


def test_frames_may_be_told_to_repeat():
    pictures, exact = Pictures(_frames("abcd"), {2}), Pictures(_frames("abbd"))
    assert [pictures.of(frame) for frame in range(4)] == [exact.of(frame) for frame in range(4)] == [0, 1, 1, 2]


@pytest.mark.parametrize("letters", ["a", "aaaa"])
def test_frames_of_one_picture_are_each_others_neighbours(letters):
    pictures = Pictures(_frames(letters))
    assert len(pictures) == len(letters)
    assert [pictures.next(frame) for frame in range(len(letters))] == [*range(1, len(letters)), None]


@pytest.mark.parametrize("letters", [PLAIN, DOUBLED, PULLED_DOWN, FROZEN])
@pytest.mark.parametrize("length", [1, 3, 6, 40])
def test_frames_without_a_neighbour_are_those_before_the_second_and_from_the_last_picture_on(letters, length):
    pictures = Pictures(_frames(letters))
    for start in range(0, len(letters), length):
        stop = min(start + length, len(letters))
        place = pictures.ends_in(start, stop)
        for t, frame in enumerate(range(start, stop), place["start"]):
            assert (t > 0) == (pictures.previous(frame) is not None)
            assert (t + 1 < place["num_frames"]) == (pictures.next(frame) is not None)


@pytest.mark.parametrize("letters", [DOUBLED, PULLED_DOWN, FROZEN])
@pytest.mark.parametrize("cue", ["saliency", "motion_network"])
def test_every_frame_of_a_picture_has_the_cues_of_the_video_without_repetitions(letters, cue):
    plain = dict(zip(PLAIN, _cues(PLAIN, cue), strict=True))
    assert _cues(letters, cue) == [plain[letter] for letter in letters]


@pytest.mark.parametrize("letters", [DOUBLED, PULLED_DOWN, FROZEN])
def test_a_run_reads_the_flow_of_the_video_without_repetitions(letters):
    plain, repeated = _complete(PLAIN), _complete(letters)
    for task in ("flow", "background"):
        read, known = ({recipe.ref for recipe in _written(graph, task)} for graph in (repeated, plain))
        assert read == known
    followed = [letter for letter in letters if letter != "i"]
    flow_to_next = dict(zip(PLAIN, map(plain.frame_cues.flow_to_next, range(8)), strict=False))
    read = [flow for recipe in _written(repeated, "flow_model") for flow in recipe.inputs["flow"]]
    assert read == [flow_to_next[letter] for letter in followed] * (len(read) // len(followed))


def test_maps_are_carried_from_frame_to_frame():
    graph = _complete("abbbc", sections={"length": 5, "overlap": 1})
    saliency = [graph.frame_cues.saliency(frame) for frame in range(5)]
    steps = [graph.frame_cues.steps(frame) for frame in range(5)]
    assert [steps[frame] == saliency[frame] for frame in range(5)] == [True, False, False, False, True]
    repeated = [graph.recipes[ref].params for ref in steps[1:4]]
    sides = [(params["previous"], params["next"]) for params in repeated]
    assert sides == [(1, 0), (0, 0), (0, 1)]
    assert all(graph.recipes[ref].inputs["saliency"] == saliency[1] for ref in steps[1:4])
    for task in ("consistency", "accumulation", "motion_memory", "coherence", "sightings"):
        assert all(list(recipe.inputs["saliency"]) == steps for recipe in _written(graph, task))
    for task in ("own_motion", "components", "moves_now"):
        assert all(list(recipe.inputs["saliency"]) == saliency for recipe in _written(graph, task))
    (components,) = _written(graph, "components")
    assert list(components.inputs["steps"]) == steps


def test_objects_grow_by_the_share_of_motion_that_lies_between_frames():
    graph = _complete("abbbc", sections={"length": 5, "overlap": 1})
    (moves,) = _written(graph, "moves_now")
    assert moves.params["previous"] == [1, 1, 0, 0, 1]
    (plain,) = _written(_complete("abcde", sections={"length": 5, "overlap": 1}), "moves_now")
    assert "previous" not in plain.params


def test_a_video_of_one_picture_is_read_as_before():
    """There is no other picture to see motion by: every frame is compared with the frames beside it."""
    graph = _complete("aaaa")
    assert not _written(graph, "saliency", "steps")
    (flow,) = {recipe.ref for recipe in _written(graph, "flow")}
    assert next(recipe.inputs["flow"] for recipe in _written(graph, "flow_model")) == (flow, flow, flow)


def test_given_flow_is_that_of_the_frames_between_which_the_picture_changes():
    flows = {
        role: tuple(f"given_flow/{digest_bytes('test', f'{role} {pair}'.encode())}" for pair in range(5))
        for role in ("flow_forward", "flow_backward")
    }
    graph = _graph("abbbcd", flows, flow={"method": "folder"})
    forward, backward = flows.values()
    assert [graph.frame_cues.flow_to_next(frame) for frame in range(5)] == [forward[i] for i in (0, 3, 3, 3, 4)]
    back = [graph.frame_cues.flow(frame, graph.frame_cues.pictures.previous(frame)) for frame in range(1, 6)]
    assert back == [backward[i] for i in (0, 0, 0, 3, 4)]


def test_the_cameras_motion_is_judged_between_pictures():
    def frames(letters):
        stretches = Stretches(_leaves(letters), PipelineConfig())
        (ref,) = stretches.choices()
        return stretches.recipes[ref]

    assert frames(DOUBLED) == frames(PULLED_DOWN) == frames(FROZEN) == frames(PLAIN)
    assert len(frames("aaaa").inputs["frames"]) == 4


def test_proof_of_motion_compares_a_frame_with_other_pictures():
    graph = _graph("abbbcddd", video_network={"use": "always"}, sections={"length": 8, "overlap": 1})
    graph.foreground.foreground(0)
    (proof,) = _written(graph, "motion_proof")
    rows = proof.params["rows"]
    assert rows == [
        [0, None, 1],
        *([row, 0, 4] for row in (1, 2, 3)),
        [4, 3, 5],
        *([row, 4, None] for row in (5, 6, 7)),
    ]
    plain = _graph(PLAIN, video_network={"use": "always"})
    plain.foreground.foreground(0)
    assert {recipe.params["method"] for recipe in _written(plain, "motion_proof")} == {"photometric"}


HEIGHT, WIDTH, SIDE, NUM_PICTURES = 120, 192, 40, 8


@pytest.fixture(scope="module")
def images():
    """Return pictures of a textured square that moves down over a panning backdrop."""
    rng = np.random.default_rng(3)

    def texture(height, width):
        return cv2.GaussianBlur(rng.integers(0, 256, (height, width, 3)).astype(np.uint8), (0, 0), 1.2)

    backdrop, square = texture(HEIGHT, WIDTH + 2 * NUM_PICTURES), texture(SIDE, SIDE)
    made = []
    for number in range(NUM_PICTURES):
        image = backdrop[:, 2 * number : 2 * number + WIDTH].copy()
        image[_place(number)] = square
        made.append(image)
    return made


def _place(number):
    """Return where the square is in a picture."""
    return slice(20 + 4 * number, 20 + 4 * number + SIDE), slice(70, 70 + SIDE)


@pytest.fixture(scope="module")
def segment(images, tmp_path_factory):
    """Return a function that segments a video of these pictures, by their numbers, and returns its masks."""
    import moseg

    store = tmp_path_factory.mktemp("store")

    def call(numbers, config=None):
        video = [images[number] for number in numbers]
        result = moseg.segment_video(video, config, store=store, fps=30, progress=False)
        return np.stack([*result.iter_labels()]) > 0

    return call


@pytest.mark.parametrize("times", [(2,), (2, 3), (1, 1, 1, 2), (1,) * 7 + (20,)], ids=str)
def test_what_moves_is_found_as_in_the_video_without_repetitions(segment, times):
    numbers = [number for number in range(NUM_PICTURES) for _ in range(times[number % len(times)])]
    plain, repeated = segment(range(NUM_PICTURES)), segment(numbers)
    for number, mask in zip(numbers, repeated, strict=True):
        true = np.zeros((HEIGHT, WIDTH), bool)
        true[_place(number)] = True
        assert _overlap(plain[number], true) > 0.8
        assert _overlap(mask, plain[number]) > 0.8


def test_a_network_of_a_video_with_repetitions_is_trained_on_what_differs(segment):
    config = {"steps": 4, "crops": 2, "crop_height": 48, "crop_width": 64, "stretch_length": 8, "use": "always"}
    numbers = [number for number in range(NUM_PICTURES) for _ in range(2)]
    masks = segment(numbers, {f"video_network.{name}": value for name, value in config.items()})
    for number, mask in zip(numbers, masks, strict=True):
        true = np.zeros((HEIGHT, WIDTH), bool)
        true[_place(number)] = True
        assert _overlap(mask, true) > 0.7


def _overlap(mask0, mask1):
    return (mask0 & mask1).sum() / (mask0 | mask1).sum()
