"""What a propagation module remembers of past frames."""

from typing import NamedTuple

import torch


class LayerMemory(NamedTuple):
    """Places of one or more frames, as one propagation module remembers them.

    Attributes
    ----------
    keys : (batch, place, d_att)
    values : (batch, place, 2 d_model)
        The visual branch's.
    identities : (batch, place, 2 d_model)
        The identity branch's: which object is there.
    """

    keys: torch.Tensor
    values: torch.Tensor
    identities: torch.Tensor


def extend_memory(memory: LayerMemory, frame: LayerMemory, max_frames: int) -> LayerMemory:
    """Long-term memory with one more frame: the first frame and the newest of the others, `max_frames` in all.

    The first frame is the only one whose masks were given rather than predicted, so it is never dropped; of the
    others the oldest goes. The published engine keeps every frame.
    """
    num_places = frame.keys.shape[1]
    num_recent = (max_frames - 1) * num_places
    kept = []
    for old, new in zip(memory, frame, strict=True):
        first, recent = old[:, :num_places], torch.cat([old[:, num_places:], new], dim=1)
        kept.append(torch.cat([first, recent[:, max(recent.shape[1] - num_recent, 0) :]], dim=1))
    return LayerMemory(*kept)
