"""Many hypotheses in the graph of a video: their keys, and motions that the size of residuals misses."""

import json

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.parameters import FlowModelParams, ObjectHypothesisParams
from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.workflows.cli.app import run
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.object_hypotheses import FLOW_PATCHES, TRACK_SAMPLES
from moseg.workflows.stages.registry import axes_of

END = {"affinity", "clustering", "segmentation", "score"}


def _put(store, recipe, arrays, attributes=None):
    """Store an artifact of a stage or a leaf."""
    return store.put(recipe, arrays, attributes, dims=axes_of(recipe.task, arrays))


def _refs(task, count):
    return tuple(f"{task}/{digest_bytes('test', str(number).encode())}" for number in range(count))


def _recipes(method, variant=Variant.FUSED, **changes):
    leaves = SequenceLeaves(
        "toy", (48, 64), _refs("frame", 9), annotation=_refs("annotation", 1)[0], masks=_refs("given_masks", 1)[0]
    )
    values = {
        "proposal_source": "groundtruth",
        "sections": {"length": 4, "overlap": 1},
        "affinity": {"method": method},
        "object_hypotheses": changes,
    }
    graph = SequenceGraph(leaves, PipelineConfig.model_validate(values))
    graph.score(variant)
    return graph.recipes


def _tasks(refs):
    return {ref.partition("/")[0] for ref in refs}


@pytest.mark.parametrize("method", ["residual", "ork"])
def test_other_affinities_draw_no_hypotheses_and_do_not_read_their_parameters(method):
    assert "object_hypotheses" not in _tasks(_recipes(method))
    assert _recipes(method, window=0.5, num_hypotheses=20) == _recipes(method)


def test_hypotheses_need_no_fit_to_an_object_and_both_together_share_each():
    alone, both = _recipes("hypotheses"), _recipes("combined")
    assert not _tasks(alone) & {"fundamental", "flow_model", "fundamental_residual", "flow_residual"}
    assert _tasks(alone.keys() - both.keys()) == END
    assert _tasks(_recipes("residual").keys() - both.keys()) == END


@pytest.mark.parametrize(
    ("changes", "variant", "moved"),
    [
        ({"num_hypotheses": 50}, Variant.FUSED, {"object_hypotheses"} | END),
        ({"background_rows": 2}, Variant.FUSED, {"object_hypotheses"} | END),
        ({"block": 4}, Variant.OC, {"object_hypotheses"} | END),
        ({"block": 4}, Variant.TRAJS, set()),
        ({"window": 0.3}, Variant.FUSED, END),
        ({"scale_quantile": 0.25}, Variant.FUSED, END),
        ({"noise_floor": 0.2}, Variant.OC, END),
        ({"noise_floor": 0.2}, Variant.TRAJS, set()),
    ],
)
def test_a_parameter_changes_the_keys_of_the_stages_that_read_it(changes, variant, moved):
    before, after = _recipes("hypotheses", variant), _recipes("hypotheses", variant, **changes)
    assert _tasks(after.keys() - before.keys()) == moved


@pytest.fixture
def residuals(tmp_path):
    """Return residuals of a frame pair whose background pans by (1, 0) px while object 1 moves by (0, 2) px."""
    store = open_store(str(tmp_path / "store"))
    masks = np.zeros((2, 64, 96), np.uint16)
    masks[:, 16:48, 32:64] = 1
    rng = np.random.default_rng(0)
    start = rng.uniform(0, [95, 63], (300, 2))
    owner = masks[0][np.rint(start[:, 1]).astype(int), np.rint(start[:, 0]).astype(int)]
    tracks = np.stack([start, start + np.where(owner[:, None] == 1, [0, 2], [1, 0])], axis=1).astype(np.float32)
    flow = np.where(masks[0][..., None] == 1, [0, 2], [1, 0]).astype(np.float32)

    def put(task, arrays, attributes=None):
        recipe = Recipe(task=task, version=1, params={"number": sum(1 for _ in store.refs())})
        _put(store, recipe, arrays, attributes)
        return recipe.ref

    boxes = np.zeros((1, 2, 4), np.int32)
    linking = put("linking", {"identity": np.array([[0, 1]], np.uint16)}, {"num_objects": 2})
    chosen = ObjectHypothesisParams(num_hypotheses=40, background_rows=2, background_columns=2, block=4)
    drawn = chosen.model_dump()
    inputs = {
        FLOW_PATCHES: {
            "proposals": put("proposals", {"masks": masks, "scores": np.ones(1), "boxes": boxes}),
            "flow": (put("flow", {"flow": flow}),),
        },
        TRACK_SAMPLES: {
            "tracks": put("tracks", {"points": tracks, "visible": np.ones((300, 2), bool), "object": owner})
        },
    }
    params = {
        FLOW_PATCHES: {
            "section": 0,
            "model": "oc",
            "flow_model": FlowModelParams(step=1).model_dump(),
            "hypotheses": drawn,
        },
        TRACK_SAMPLES: {
            "section": 0,
            "num_pairs": 1,
            "gap": 1,
            "shape": [64, 96],
            "min_points": 8,
            "hypotheses": drawn,
        },
    }

    def call(task):
        recipe = Recipe(task="object_hypotheses", version=1, params={}, inputs={**inputs[task], "linking": linking})
        (output,) = task.compute(params[task], [Inputs(store, recipe)], [np.random.default_rng(0)])
        return output.arrays["residual"]

    return call


@pytest.mark.parametrize(("task", "num_models"), [(FLOW_PATCHES, 1), (TRACK_SAMPLES, 2)])
def test_one_hypothesis_explains_the_cells_of_the_background_but_not_the_moving_object(residuals, task, num_models):
    found = residuals(task)
    assert found.shape == (1, num_models, 40, 2 + 4)
    assert found.dtype == np.float32
    assert np.isnan(found[..., 0]).all()
    of_background = found[0, -1][(found[0, -1][:, 2:] < 1e-3).all(axis=1)]
    assert len(of_background) >= 3
    assert of_background[:, 1].min() > 0.5


def test_many_hypotheses_find_the_moving_object_that_fits_to_each_object_miss(tmp_path):
    """Trajectories alone, the number of motions not given: fitted to few tracks of one object, a fundamental matrix
    explains too much."""
    scores = {}
    for method in ("residual", "hypotheses"):
        out = tmp_path / f"{method}.json"
        cues = [f"--{cue}=groundtruth" for cue in ("proposals", "tracks", "flow", "depth")]
        scene = ["--sequences", "occlusion", "--variant", "trajs", "--affinity", method, "--motions", "auto"]
        assert run(["eval", "--quiet", *cues, *scene, "--store", f"{tmp_path}/store", "--json", str(out)]) == 0
        scores[method] = json.loads(out.read_text())["rows"][0]["mean"]["F"]
    assert scores["residual"] < 50
    assert scores["hypotheses"] == pytest.approx(100.0)
