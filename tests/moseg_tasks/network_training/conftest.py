"""Samples that are learned in a few steps."""

import numpy as np
import pytest
import torch

from moseg.tasks.motion_network import CHANNELS
from moseg.tasks.network_training.batch import Batch, pad_batch


@pytest.fixture
def batch() -> Batch:
    """Return four samples in whose channels the moving square is plain to see."""
    rng = np.random.default_rng(0)
    channels = rng.normal(0, 0.2, (4, len(CHANNELS), 30, 44))
    label = np.zeros((4, 30, 44))
    for index, (top, left) in enumerate(rng.integers(0, 15, (4, 2))):
        label[index, top : top + 12, left : left + 12] = 1
    channels += 2 * label[:, None]
    return pad_batch(*map(torch.from_numpy, (channels, label, np.ones(label.shape))))
