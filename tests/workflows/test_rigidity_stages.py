"""The stages of dense tracks and rigidity, from stored frames and flows to stored evidence."""

import json

import cv2
import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.registry import axes_of, find_stage

HEIGHT, WIDTH, NUM_FRAMES = 96, 128, 6


@pytest.fixture
def store(tmp_path):
    return open_store(str(tmp_path / "store"))


@pytest.fixture
def put(store):
    """Function that stores an artifact and returns its reference."""

    def call(task, arrays, number=0):
        recipe = Recipe(task=task, version=1, params={"number": number})
        store.put(recipe, arrays, None, dims=axes_of(task, arrays))
        return recipe.ref

    return call


@pytest.fixture
def compute(store):
    """Function that runs a stage as the graph would, stores its output and returns its reference."""

    def call(name, inputs, depth="none", step=1, **values):
        stage, config = find_stage(name), PipelineConfig.model_validate({"depth": {"method": depth}, **values})
        task = stage.task(stage.chosen(config))
        params = task.params(config, step=step)
        assert set(inputs) <= set(stage.inputs)
        recipe = Recipe(task=name, version=task.version, params={"method": task.method, **params}, inputs=inputs)
        (output,) = task.compute(params, [Inputs(store, recipe)], [np.random.default_rng(0)])
        store.put(recipe, output.arrays, json.loads(json.dumps(output.attributes)), dims=axes_of(name, output.arrays))
        return recipe.ref

    return call


IS_NEAR = np.arange(WIDTH) < WIDTH // 2


def approached(num_frames, is_textured=True):
    """Frames of a wall whose left half is twice as near, and float32 flows to the next frame and to the one before."""
    noise = np.random.default_rng(0).normal(size=(HEIGHT, WIDTH)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 1.5)
    gray = np.clip(128 + 50 * smooth / smooth.std() * is_textured, 0, 255).astype(np.uint8)
    middle = np.array([WIDTH, HEIGHT]) / 2
    away = np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), axis=-1) - middle
    shrink = np.where(IS_NEAR, 0.96, 0.98)[:, None]
    sources = [(away * shrink**t + middle).astype(np.float32) for t in range(num_frames)]
    grays = [cv2.remap(gray, *source.transpose(2, 0, 1), cv2.INTER_CUBIC) for source in sources]
    images = [np.repeat(gray[..., None], 3, axis=2) for gray in grays]
    return images, (away / shrink - away).astype(np.float32), (away * shrink - away).astype(np.float32)


@pytest.mark.parametrize(("is_textured", "num_frames"), [(True, NUM_FRAMES), (False, NUM_FRAMES), (True, 1)])
def test_evidence_is_stored_for_the_tracks_of_a_window(put, compute, store, is_textured, num_frames):
    images, forward, backward = approached(num_frames, is_textured)
    frames = tuple(put("frame", {"image": image}, t) for t, image in enumerate(images))
    # What the flow does not know is filled in.
    forward[:5, :5] = np.nan
    inputs = {
        "frames": frames,
        "flow_forward": (put("flow", {"flow": forward}, 0),) * (num_frames - 1),
        "flow_backward": (put("flow", {"flow": backward}, 1),) * (num_frames - 1),
    }
    tracks = compute("dense_tracks", inputs)
    visible = store.read(tracks, "visible")
    assert visible.shape[1] == num_frames
    assert (len(visible) > 100) == (is_textured and num_frames > 1)
    rigidity = compute("rigidity", {"dense_tracks": tracks, "frames": frames})
    pairs, error = store.read(rigidity, "pairs"), store.read(rigidity, "error")
    assert error.shape == (len(pairs), len(visible))
    attributes = store.attributes(rigidity)
    assert attributes["focal"] in PipelineConfig().rigidity.focals
    assert len(attributes["cameras"]) == len(pairs)
    if len(pairs):
        assert np.array(attributes["cameras"][0]["rotation"]).shape == (3, 3)
        assert np.isfinite(error).any(axis=1).all()


def test_depth_of_the_window_is_read_where_it_is_given(put, compute, store):
    images, forward, backward = approached(NUM_FRAMES)
    frames = tuple(put("frame", {"image": image}, t) for t, image in enumerate(images))
    flows = {"flow_forward": forward, "flow_backward": backward}
    flows = {role: (put("flow", {"flow": flow}, role),) * (NUM_FRAMES - 1) for role, flow in flows.items()}
    tracks = compute("dense_tracks", {"frames": frames, **flows})
    true = np.where(IS_NEAR, 2.0, 1.0) * np.ones((HEIGHT, 1))
    wrong = true.copy()
    wrong[10:50, 5:45] = 1
    inputs = {"dense_tracks": tracks, "frames": frames}
    shares = []
    for number, given in enumerate((true, wrong)):
        depth = put("given_depth", {"inverse_depth": given.astype(np.float32)}, number)
        ref = compute("rigidity", {**inputs, "depth": (depth,) * NUM_FRAMES}, depth="groundtruth")
        error, points = store.read(ref, "error"), store.read(tracks, "points")[:, 0]
        x, y = points.T
        inside = store.read(tracks, "visible")[:, 0] & (x > 10) & (x < 35) & (y > 15) & (y < 40)
        shares.append(np.mean(error[:2, inside] > 1))
    assert shares[0] < 0.1
    assert shares[1] > 0.5


@pytest.mark.parametrize(
    "values",
    [
        {"rigidity": {"gaps": (1,)}},
        {"rigidity": {"gaps": (2,)}},
        {"rigidity": {"gaps": (1,), "focal_gap": 1}},
        {"rigidity": {"gaps": (2,)}, "dense_tracks": {"min_frames": 5}},
    ],
)
def test_tracks_of_apart_pairs_are_long_enough_to_be_kept_and_to_choose_the_focal_length(put, compute, store, values):
    num_frames, step = 11, 5
    images, forward, backward = approached(num_frames)
    inputs = {"frames": tuple(put("frame", {"image": image}, t) for t, image in enumerate(images))}
    for number, (role, flow) in enumerate({"flow_forward": forward, "flow_backward": backward}.items()):
        inputs[role] = (put("flow", {"flow": flow}, number),) * (num_frames - 1)
    visible = store.read(compute("dense_tracks", inputs, step=step, **values), "visible")
    gap = PipelineConfig.model_validate(values).rigidity.focal_gap
    assert np.count_nonzero(visible[:, [0, step]] & visible[:, [gap, step + gap]], axis=0).min() > 20


def test_without_depth_its_parameters_are_not_in_the_recipe():
    task = find_stage("rigidity").tasks[0]
    without, given = (PipelineConfig(depth={"method": method}) for method in ("none", "groundtruth"))
    more = set(task.params(given)) - set(task.params(without))
    assert more == {name for name in task.params(given) if name.startswith("depth_")}
    assert more


@pytest.mark.parametrize("gaps", ["", "0,2", "2,2", (2, -1)])
def test_gaps_are_different_numbers_of_frames(gaps):
    with pytest.raises(ValueError, match="gaps"):
        PipelineConfig.model_validate({"rigidity": {"gaps": gaps}})
    assert PipelineConfig.model_validate({"rigidity": {"gaps": "1, 3"}}).rigidity.gaps == (1, 3)
