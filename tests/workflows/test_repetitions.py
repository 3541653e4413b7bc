"""Frames that repeat others and were coded again: the recipes that look for them, and whole runs."""

import av
import cv2
import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.digests import digest_bytes
from moseg.store import open_store
from moseg.workflows.graph import Repetitions, SequenceGraph, SequenceLeaves

LENGTH, WINDOW = 8, 2


def _leaves(letters, **given):
    frames = tuple(f"frame/{digest_bytes('test', str(letter).encode())}" for letter in letters)
    return SequenceLeaves("toy", (48, 64), frames, **given)


def _search(letters, **repetitions):
    """Return the writer of the search in a video of these frames, and its recipes in order."""
    values = {"stretch_length": LENGTH, "window": WINDOW} | repetitions
    writer = Repetitions(_leaves(letters), PipelineConfig.model_validate({"repetitions": values}))
    return writer, [writer.recipes[ref] for ref in writer.refs()]


def test_every_frame_is_judged_once_with_a_window_on_either_side():
    writer, recipes = _search(range(30))
    judged = []
    for recipe in recipes:
        first, last = recipe.params["first"], recipe.params["last"]
        frames = [_leaves(range(30)).frames.index(ref) for ref in recipe.inputs["frames"]]
        assert first in (0, WINDOW + 1) and len(frames) - last in (0, WINDOW)
        judged += frames[first:last]
    assert judged == [*range(30)]
    rows = [[recipe.params["first"]] for recipe in recipes]
    assert writer.frames(rows) == (0, 8, 16, 24)


def test_frames_that_are_equal_are_read_once():
    writer, (recipe,) = _search("aabbbcdd")
    assert len(recipe.inputs["frames"]) == 4
    # The third and the fourth picture begin at these frames.
    assert writer.frames([[2, 3]]) == (5, 6)


def test_the_place_of_a_stretch_is_in_no_key():
    _, before = _search([*range(40)])
    _, after = _search([*range(100, 108), *range(40)])
    assert {recipe.ref for recipe in before[1:]} <= {recipe.ref for recipe in after}


@pytest.mark.parametrize("letters", ["a", "ab"])
def test_two_frames_have_nothing_to_be_compared_with(letters):
    assert not _search(letters)[1]


def test_nothing_is_compared_where_that_is_switched_off():
    assert not _search(range(30), max_change=0)[1]


def test_the_graph_takes_repetitions_for_frames_of_one_picture():
    config = PipelineConfig.model_validate({"motion_network": {"use": "never"}})
    cues = SequenceGraph(_leaves("abcd", repetitions=(2,)), config).frame_cues
    plain = SequenceGraph(_leaves("abcd"), config).frame_cues
    assert [cues.pictures.next(frame) for frame in range(4)] == [1, 3, 3, None]
    assert cues.flow_to_next(1) == cues.flow(1, 3) != plain.flow_to_next(1)
    assert SequenceGraph(_leaves("abcd", repetitions=()), config).frame_cues.saliency(1) == plain.saliency(1)


HEIGHT, WIDTH, SIDE, NUM_PICTURES = 120, 192, 40, 8


def _place(number):
    """Return where the square is in a picture."""
    return slice(20 + 4 * number, 20 + 4 * number + SIDE), slice(70, 70 + SIDE)


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    """Return a function that writes an H.264 file of pictures: a textured square over a panning backdrop."""
    rng, folder = np.random.default_rng(3), tmp_path_factory.mktemp("film")

    def texture(height, width):
        return cv2.GaussianBlur(rng.integers(0, 256, (height, width, 3)).astype(np.uint8), (0, 0), 1.5)

    backdrop, square = texture(HEIGHT, WIDTH + 2 * NUM_PICTURES), texture(SIDE, SIDE)

    def write(numbers):
        path = folder / f"{len(numbers)}.mp4"
        with av.open(str(path), "w") as container:
            stream = container.add_stream("libx264", rate=30, options={"crf": "23"})
            stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
            for number in numbers:
                image = backdrop[:, 2 * number : 2 * number + WIDTH].copy()
                image[_place(number)] = square
                container.mux(stream.encode(av.VideoFrame.from_ndarray(image)))
            container.mux(stream.encode())
        return path

    return write


@pytest.mark.parametrize("times", [1, 2])
def test_what_moves_is_found_though_its_frames_were_coded_again(film, tmp_path, times):
    import moseg

    numbers = [number for number in range(NUM_PICTURES) for _ in range(times)]
    result = moseg.segment_video(film(numbers), store=tmp_path / "store", progress=False)
    for number, mask in zip(numbers, result.iter_labels(), strict=True):
        true = np.zeros((HEIGHT, WIDTH), bool)
        true[_place(number)] = True
        assert ((mask > 0) & true).sum() / ((mask > 0) | true).sum() > 0.8
    store = open_store(str(tmp_path / "store"), create=False)
    (ref,) = store.refs("repetitions")
    assert len(store.attributes(ref)["repetitions"]) in ((0,) if times == 1 else range(1, NUM_PICTURES + 1))
