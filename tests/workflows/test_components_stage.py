"""The stage that makes objects of the foreground: parts, and what is seen again behind something."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.components import SPACE_TIME

SHAPE = (80, 200)
NUM_FRAMES = 45


class _View:
    """Stored artifact of given arrays."""

    def __init__(self, **arrays):
        self.arrays = arrays

    def array(self, name):
        return self.arrays[name]

    def rows(self, name, start, stop):
        return self.arrays[name][start:stop]

    def shape(self, name):
        return self.arrays[name].shape

    def derived(self, name, variant, derive):
        return derive(self.arrays[name])


class _Inputs(dict):
    def all(self, role):
        return self[role]


def _objects(place, velocity):
    """Labels of what is at place(t), bool (y, x), where all moves by `velocity(t)`, px/frame to the right."""
    masks = np.stack([place(t) for t in range(NUM_FRAMES)])
    saliency = []
    for t, mask in enumerate(masks):
        flow = np.zeros((2, *SHAPE, 2), np.float16)
        for direction, other in ((0, t - 1), (1, t + 1)):
            if 0 <= other < NUM_FRAMES:
                flow[direction, ..., 0] = np.where(mask, (other - t) * velocity(t), 0)
        saliency.append(_View(flows=flow, residual_flows=flow))
    images = np.where(masks[..., None], np.uint8([200, 60, 40]), np.uint8([90, 110, 90]))
    inputs = _Inputs(
        foreground=[_View(foreground=masks.astype(np.float16))],
        frames=[_View(image=image) for image in images],
        saliency=saliency,
    )
    params = SPACE_TIME.params(PipelineConfig(), NUM_FRAMES, 1)
    (output,) = SPACE_TIME.compute(params, [inputs], [np.random.default_rng(0)])
    assert output.arrays["scores"].shape == (output.arrays["labels"].max(),)
    return masks, output.arrays["labels"]


def _box(mask, left, width=20):
    mask[30:50, max(int(left), 0) : int(left) + width] = True


def test_objects_that_part_have_labels_of_their_own():
    def place(t):
        mask = np.zeros(SHAPE, bool)
        _box(mask, 10)
        _box(mask, 30 + 3 * t)
        return mask

    def velocity(t):
        return np.where(np.arange(SHAPE[1]) < 30, 0, 3)

    masks, labels = _objects(place, velocity)
    np.testing.assert_array_equal(labels > 0, masks)
    rests, leaves = labels[0, 40, 20], labels[-1, 40, 170]
    assert rests != leaves
    np.testing.assert_array_equal(labels[:, :, :30], rests * masks[:, :, :30])
    np.testing.assert_array_equal(labels[:, :, 30:], leaves * masks[:, :, 30:])


@pytest.mark.parametrize("hidden", [(80, 110), (80, 112)])
def test_what_shows_at_both_sides_of_what_hides_it_is_one_object(hidden):
    def place(t):
        mask = np.zeros(SHAPE, bool)
        _box(mask, 6 + 3 * t, width=60)
        mask[:, slice(*hidden)] = False
        return mask

    masks, labels = _objects(place, lambda t: 3)
    np.testing.assert_array_equal(labels > 0, masks)
    assert labels.max() == 1
