"""Batches of samples, augmented."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.motion_network.encoding import CHANNELS, PER_DIRECTION
from moseg.tasks.motion_network.inference import STRIDE

_PREVIOUS, _NEXT = slice(0, len(PER_DIRECTION)), slice(len(PER_DIRECTION), 2 * len(PER_DIRECTION))
_HORIZONTAL = [index for index, name in enumerate(CHANNELS) if "_u_" in name]
_VECTORS = [index for index, name in enumerate(CHANNELS) if "_u_" in name or "_v_" in name]


class Batch(NamedTuple):
    """Samples of one size, whose sides are multiples of the network's stride.

    Attributes
    ----------
    channels : float32 (sample, channel, y, x)
    label : float32 (sample, y, x)
        Share of each pixel that moves on its own, 0..1.
    weight : float32 (sample, y, x)
        0 where the label is uncertain and beyond the border of the frame.
    """

    channels: np.ndarray
    label: np.ndarray
    weight: np.ndarray


def pad_batch(channels: np.ndarray, label: np.ndarray, weight: np.ndarray) -> Batch:
    """Return a batch of arrays of any type, padded at the bottom and at the right: channels and label by their edge.

    Parameters
    ----------
    channels : array (sample, channel, y, x)
    label : array (sample, y, x)
        0..1.
    weight : array (sample, y, x)
    """
    sides = [(0, -length % STRIDE) for length in channels.shape[2:]]
    return Batch(
        np.pad(channels.astype(np.float32), [(0, 0), (0, 0), *sides], mode="edge"),
        np.pad(label.astype(np.float32), [(0, 0), *sides], mode="edge"),
        np.pad(weight.astype(np.float32), [(0, 0), *sides]),
    )


def augment(batch: Batch, rng: np.random.Generator, missing: float) -> Batch:
    """Mirror and reverse in time each half of the samples, and leave out a time direction of a few.

    Parameters
    ----------
    batch : Batch
    rng : numpy.random.Generator
    missing : float
        Chance of each direction to be missing: the other one stands for it, as at the ends of a video.
    """
    channels, label, weight = (array.copy() for array in batch)
    for index in range(len(channels)):
        sample = channels[index]
        mirrors, reverses = rng.random(2) < 0.5
        if mirrors:
            sample[:] = sample[:, :, ::-1].copy()
            sample[_HORIZONTAL] *= -1
            label[index], weight[index] = label[index, :, ::-1].copy(), weight[index, :, ::-1].copy()
        if reverses:
            sample[_PREVIOUS], sample[_NEXT] = sample[_NEXT].copy(), sample[_PREVIOUS].copy()
            sample[_VECTORS] *= -1
        left_out = rng.random()
        if left_out < missing:
            sample[_PREVIOUS] = sample[_NEXT]
        elif left_out < 2 * missing:
            sample[_NEXT] = sample[_PREVIOUS]
    return Batch(channels, label, weight)
