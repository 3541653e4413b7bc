"""Batches and their augmentation."""

import numpy as np
import pytest

from moseg.tasks.motion_network import CHANNELS
from moseg.tasks.network_training.batch import augment


def test_padding_has_no_weight(batch):
    assert batch.channels.shape == (4, len(CHANNELS), 32, 48)
    assert batch.weight[:, :30, :44].all() and not batch.weight[:, 30:].any() and not batch.weight[:, :, 44:].any()


@pytest.mark.parametrize("seed", range(3))
def test_mirroring_and_reversing_twice_gives_the_sample_again(batch, seed):
    once = augment(batch, np.random.default_rng(seed), 0.0)
    twice = augment(once, np.random.default_rng(seed), 0.0)
    for before, middle, after in zip(batch, once, twice, strict=True):
        np.testing.assert_array_equal(before, after)
        assert not np.array_equal(before, middle)


def test_a_missing_direction_is_that_of_the_other(batch):
    channels = augment(batch, np.random.default_rng(0), 0.5).channels
    by_name = dict(zip(CHANNELS, channels.swapaxes(0, 1), strict=True))
    np.testing.assert_array_equal(by_name["residual_u_previous"], by_name["residual_u_next"])
