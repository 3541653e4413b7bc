"""The pixels that the flow models of a section read."""

import numpy as np
import pytest

from moseg.schemas.parameters import FlowModelParams
from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.tasks.motion_models import unpack_moments
from moseg.workflows.stages.flow_model import LEAST_SQUARES_FIT
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.registry import axes_of

HEIGHT, WIDTH = 24, 32


def _put(store, recipe, arrays, attributes=None):
    """Store an artifact of a stage or a leaf."""
    return store.put(recipe, arrays, attributes, dims=axes_of(recipe.task, arrays))


@pytest.fixture
def fit(tmp_path):
    """Return a function that fits one pair's flow: a static background, and an object that moves by (3, 1) px."""
    store = open_store(str(tmp_path / "store"))
    masks = np.zeros((1, HEIGHT, WIDTH), np.uint16)
    masks[0, 4:16, 8:24] = 1

    def put(task, arrays, attributes=None):
        recipe = Recipe(task=task, version=1, params={"number": sum(1 for _ in store.refs())})
        _put(store, recipe, arrays, attributes)
        return recipe.ref

    def call(step, known=None):
        flow = np.zeros((HEIGHT, WIDTH, 2), np.float32)
        flow[masks[0] == 1] = 3, 1
        if known is not None:
            flow[~known] = np.nan
        boxes = np.zeros((1, 1, 4), np.int32)
        inputs = {
            "proposals": put("proposals", {"masks": masks, "scores": np.ones(1), "boxes": boxes}),
            "linking": put("linking", {"identity": np.array([[0, 1]], np.uint16)}, {"num_objects": 2}),
            "flow": (put("flow", {"flow": flow}),),
        }
        flow_model = FlowModelParams(step=step).model_dump(mode="json")
        params = {"model": "oc", "section": 0, "flow_model": flow_model}
        recipe = Recipe(task="flow_model", version=1, params=params, inputs=inputs)
        (output,) = LEAST_SQUARES_FIT.compute(params, [Inputs(store, recipe)], [np.random.default_rng(0)])
        return output.arrays

    return call


@pytest.mark.parametrize(("step", "counts"), [(1, (576, 192)), (2, (144, 48)), (3, (68, 20))])
def test_every_so_many_rows_and_columns_are_read(fit, step, counts):
    found = fit(step)
    assert tuple(unpack_moments(found["moments"][0]).count) == counts
    np.testing.assert_allclose(found["theta"][0, :, [0, 6]], [[0, 3], [0, 1]], atol=1e-9)


def test_flow_that_is_known_in_places_is_read_everywhere(fit):
    known = np.indices((HEIGHT, WIDTH)).sum(axis=0) % 2 == 1
    found = fit(2, known)
    assert tuple(unpack_moments(found["moments"][0]).count) == (288, 96)
