"""Batches of samples, augmented on the device on which the network is trained."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from moseg.tasks.motion_network.encoding import CHANNELS, PER_DIRECTION
from moseg.tasks.motion_network.inference import STRIDE

_PREVIOUS, _NEXT = slice(0, len(PER_DIRECTION)), slice(len(PER_DIRECTION), 2 * len(PER_DIRECTION))
_SIGN_MIRRORED = np.array([-1.0 if "_u_" in name else 1.0 for name in CHANNELS], np.float32)
_SIGN_REVERSED = np.array([-1.0 if "_u_" in name or "_v_" in name else 1.0 for name in CHANNELS], np.float32)


class Batch(NamedTuple):
    """Samples of one size, whose sides are multiples of the network's stride, on one device.

    Attributes
    ----------
    channels : Tensor, float32 (sample, channel, y, x)
    label : Tensor, float32 (sample, y, x)
        Share of each pixel that moves on its own, 0..1.
    weight : Tensor, float32 (sample, y, x)
        0 where the label is uncertain and beyond the border of the frame.
    """

    channels: Tensor
    label: Tensor
    weight: Tensor


def pad_batch(channels: Tensor, label: Tensor, weight: Tensor) -> Batch:
    """Return a batch of tensors of any type, padded at the bottom and at the right: channels and label by their edge.

    Parameters
    ----------
    channels : Tensor (sample, channel, y, x)
    label : Tensor (sample, y, x)
        0..1.
    weight : Tensor (sample, y, x)
    """
    return Batch(
        pad_channels(channels),
        pad_channels(label[:, None])[:, 0],
        functional.pad(weight.float(), _missing_sides(weight)),
    )


def pad_channels(channels: Tensor) -> Tensor:
    """Return maps (sample, channel, y, x) of any type as float32, padded by their edge to multiples of the stride."""
    return functional.pad(channels.float(), _missing_sides(channels), mode="replicate")


def augment(batch: Batch, rng: np.random.Generator, missing: float) -> Batch:
    """Mirror and reverse in time each half of the samples, and leave out a time direction of a few.

    Parameters
    ----------
    batch : Batch
    rng : numpy.random.Generator
    missing : float
        Chance of each direction to be missing: the other one stands for it, as at the ends of a video.
    """
    drawn = rng.random((len(batch.channels), 3))
    mirrors, reverses, left_out = drawn[:, 0] < 0.5, drawn[:, 1] < 0.5, drawn[:, 2]
    order = np.tile(np.arange(len(CHANNELS)), (len(drawn), 1))
    order[reverses, _PREVIOUS], order[reverses, _NEXT] = order[reverses, _NEXT], order[reverses, _PREVIOUS]
    first, second = left_out < missing, (missing <= left_out) & (left_out < 2 * missing)
    order[first, _PREVIOUS] = order[first, _NEXT]
    order[second, _NEXT] = order[second, _PREVIOUS]
    sign = np.where(mirrors[:, None], _SIGN_MIRRORED, 1) * np.where(reverses[:, None], _SIGN_REVERSED, 1)
    device = batch.channels.device
    which, factor = torch.from_numpy(order).to(device), torch.from_numpy(sign).to(device)
    is_mirrored = torch.from_numpy(mirrors).to(device)
    channels = torch.take_along_dim(batch.channels, which[:, :, None, None], 1) * factor[:, :, None, None]
    return Batch(*(_mirror(each, is_mirrored) for each in (channels, batch.label, batch.weight)))


def _mirror(maps: Tensor, is_mirrored: Tensor) -> Tensor:
    """Mirror those samples of (sample, ..., x) that `is_mirrored` (sample,) names."""
    return torch.where(is_mirrored.view(-1, *[1] * (maps.ndim - 1)), maps.flip(-1), maps)


def _missing_sides(maps: Tensor) -> tuple[int, int, int, int]:
    """Return what maps (..., y, x) lack at the left, right, top and bottom."""
    height, width = maps.shape[-2:]
    return 0, -width % STRIDE, 0, -height % STRIDE
