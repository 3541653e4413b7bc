"""Results do not depend on where a video is cut into sections, or only within a bound."""

from functools import partial

import cv2
import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import open_session
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.sources import open_frames

NUM_FRAMES, HEIGHT, WIDTH, SIDE = 24, 120, 192, 56
SHORT, WHOLE = 8, NUM_FRAMES
BORDERS = range(SHORT, NUM_FRAMES, SHORT)
CARRIED = {"accumulation_past": "maps", "accumulation_future": "maps"}
CARRIED |= {"coherence_past": "misfit", "coherence_future": "misfit"}


@pytest.fixture(scope="module")
def clip(tmp_path_factory, write_image):
    """Return a folder of frames: a textured square oscillates and turns from red to blue over a panning backdrop."""
    folder = tmp_path_factory.mktemp("clip")
    rng = np.random.default_rng(3)

    def texture(height, width):
        noise = rng.integers(0, 256, (height, width, 3)).astype(np.uint8)
        return cv2.GaussianBlur(noise, (0, 0), 1.2) // 2

    backdrop, square = texture(HEIGHT, WIDTH + NUM_FRAMES) + np.uint8(60), texture(SIDE, SIDE)
    for number in range(NUM_FRAMES):
        image = backdrop[:, number : number + WIDTH].copy()
        x = round(68 + 50 * np.sin(number / 5))
        tint = np.array([40 + 3 * number, 60, 40 + 3 * (NUM_FRAMES - number)], np.uint8)
        image[34 : 34 + SIDE, x : x + SIDE] = square + tint
        write_image(folder / f"{number:05d}.png", image)
    return folder


@pytest.fixture(scope="module")
def run(clip, tmp_path_factory):
    """Return a function that segments the clip in sections of a length and returns its arrays by name."""
    store = str(tmp_path_factory.mktemp("store"))
    with open_session(store, quiet=True) as session:
        yield partial(_run, session, clip)


@pytest.fixture(scope="module")
def runs(run):
    """Return the arrays of runs by the length of their sections."""
    return {length: run(length) for length in (SHORT, WHOLE)}


def _run(session, clip, length, **appearance):
    values = {"sections": {"length": length, "overlap": 3}, "appearance": appearance}
    config = PipelineConfig.model_validate(values)
    source = SequenceSource("clip", open_frames(str(clip), config.max_side))
    (leaves,) = ingest_sequences(session, [source], config, annotated=False)
    graph = SequenceGraph(leaves, config)
    sinks = graph.segmentations(Variant.BASE)
    refs = {"labels": sinks, "foreground": [graph.foreground.foreground(index) for index in range(len(sinks))]}
    for role in CARRIED:
        refs[role] = [graph.recipes[ref].inputs[role] for ref in refs["foreground"]]
    names = {"labels": "labels", "foreground": "foreground", **CARRIED}

    def read():
        return {
            role: np.concatenate([session.store.read(ref, names[role]) for ref in refs[role]]).astype(np.float64)
            for role in names
        }

    return session.compute(lambda: (graph.recipes, sinks), read)


@pytest.mark.parametrize("role", CARRIED)
def test_passes_along_the_flow_give_the_same_bits_for_any_cuts(runs, role):
    assert runs[WHOLE][role].any()
    for cut, whole in zip(runs[SHORT][role], runs[WHOLE][role], strict=True):
        np.testing.assert_array_equal(cut, whole)


def test_the_foreground_differs_within_the_bound_of_the_weights_of_colours(runs):
    config = PipelineConfig()
    # All frames of a section have the same weight in its colours: those of WHOLE all 1, those of SHORT from 1 down to
    # this. It bounds how far two means, and so two shares of a colour, are apart.
    least_weight = config.appearance.memory ** (NUM_FRAMES - SHORT)
    shares = 2 * config.foreground.colour_weight + config.foreground.reliability_weight
    # No slope of a probability over its logit is over 1/4; float16 has eleven bits.
    largest = shares * -np.log(least_weight) / 4 + 2**-11
    change = np.abs(runs[SHORT]["foreground"] - runs[WHOLE]["foreground"])
    assert 0 < change.max() < largest
    assert change.mean() < largest / 20


def test_the_foreground_has_no_step_at_a_cut(run, runs):
    # Colours of the next section hardly count, so that what is learnt of them changes much from section to section.
    change = run(SHORT, memory=0.8)["foreground"] - runs[WHOLE]["foreground"]
    steps = {t: np.abs(change[t] - change[t - 1]).mean() for t in range(1, NUM_FRAMES)}
    at_cuts = [steps.pop(t) for t in BORDERS]
    assert max(at_cuts) <= max(steps.values())


def test_masks_are_the_same_for_any_cuts(runs):
    cut, whole = (runs[length]["labels"] > 0 for length in (SHORT, WHOLE))
    shared, either = (cut & whole).sum(axis=(1, 2)), (cut | whole).sum(axis=(1, 2))
    assert (shared > 0.97 * either).all()


def test_masks_do_not_grow_or_shrink_at_a_cut(runs):
    cut, whole = ((runs[length]["labels"] > 0).sum(axis=(1, 2)) for length in (SHORT, WHOLE))
    change = cut - whole
    # Pixels that flip in a single frame are no growth: a step lasts if it is there between the frames around too.
    steps = {
        t: min(abs(change[t] - change[t - 1]), abs(change[t + 1] - change[t - 2])) for t in range(2, NUM_FRAMES - 1)
    }
    at_cuts = [steps.pop(t) for t in BORDERS]
    assert max(at_cuts) <= max(steps.values())


def test_an_object_keeps_its_identity_through_all_cuts(runs):
    assert all(set(np.unique(labels)) == {0, 1} for labels in runs[SHORT]["labels"])
