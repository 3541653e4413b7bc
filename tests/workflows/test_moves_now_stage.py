"""The stage that says whether objects move, and how their flow makes them grow."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.moves_now import BEYOND_NOISE

SHAPE = (80, 100)
BOX = np.s_[20:60, 30:70]


class _View:
    """Stored artifact of given arrays."""

    def __init__(self, attributes=None, **arrays):
        self.attributes, self.arrays = attributes, arrays

    def array(self, name):
        return self.arrays[name]

    def shape(self, name):
        return self.arrays[name].shape


class _Inputs(dict):
    def all(self, role):
        return self[role]


def _growth(factors, start=1, num_frames=None, **params):
    """Return the growth of an object whose area is these times that in the frame before, as its flow to there says.

    The flow to the next frame says otherwise, and so do both residuals.
    """
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]] - np.array([40, 50])[:, None, None]
    saliency = []
    for factor in factors:
        flows = np.zeros((2, *SHAPE, 2), np.float16)
        flows[0] = (1 / np.sqrt(factor) - 1) * np.stack([x, y], axis=-1) + 3
        flows[1] = 0.2 * np.stack([x, y], axis=-1)
        saliency.append(_View(flows=flows, residual_flows=flows[::-1], saliency=flows[0, ..., 0]))
    labels = np.zeros((len(factors), *SHAPE), np.uint16)
    labels[:, BOX[0], BOX[1]] = 1
    inputs = _Inputs(segmentation=_View(labels=labels), linking=_View({"num_objects": 2}), saliency=saliency)
    num_frames = start + len(factors) + 1 if num_frames is None else num_frames
    read = BEYOND_NOISE.params(PipelineConfig(), start, num_frames, **params)
    (output,) = BEYOND_NOISE.compute(read, [inputs], [np.random.default_rng(0)])
    assert np.isnan(output.arrays["growth"][:, 0]).all()
    assert output.arrays["moves"].shape == output.arrays["growth"].shape
    return output.arrays["growth"][:, 1]


def test_objects_grow_as_the_flow_to_the_frame_before_says():
    factors = [0.8, 1.0, 1.3]
    np.testing.assert_allclose(_growth(factors), np.log(factors), atol=0.01)


def test_the_first_frame_of_a_video_has_no_growth():
    found = _growth([0.8, 0.8], start=0)
    assert np.isnan(found[0]) and found[1] == pytest.approx(np.log(0.8), abs=0.01)


def test_growth_is_shared_out_between_frames():
    """To a repetition there is none, and to a picture four frames away a quarter of it."""
    found = _growth([0.8, 0.8, 0.8], previous=[1.0, 0.0, 0.25])
    np.testing.assert_allclose(found, np.log(0.8) * np.array([1, 0, 0.25]), atol=0.01)
