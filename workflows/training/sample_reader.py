"""Samples of shards on the device on which the network is trained."""

from typing import TYPE_CHECKING

import numpy as np

from moseg.workflows.training.shards import Shard

if TYPE_CHECKING:
    import torch
    from torch import Tensor

    from moseg.tasks.network_training.batch import Batch

_FREE_SHARE = 0.4
"""Share of a GPU's memory that is left to the training."""


class SampleReader:
    """Reads samples; on a GPU, shards that were read once stay in its memory as far as they fit.

    Parameters
    ----------
    device : torch.device
    """

    def __init__(self, device: "torch.device"):
        self._device = device
        self._kept: dict[Shard, tuple[Tensor, ...]] = {}

    def read(self, shard: Shard, rows: np.ndarray | slice) -> "Batch":
        """Return samples of a shard, padded."""
        import torch

        from moseg.tasks.network_training.batch import pad_batch

        kept = self._kept.get(shard)
        if kept is None and self._has_room():
            kept = self._kept[shard] = tuple(self._load(array) for array in shard.read())
        if kept is None:
            channels, label, counts = (self._load(array[rows]) for array in shard.read())
        else:
            which = rows if isinstance(rows, slice) else torch.from_numpy(rows).to(self._device)
            channels, label, counts = (array[which] for array in kept)
        return pad_batch(channels, label / 255, counts)

    def _load(self, array: np.ndarray) -> "Tensor":
        import torch

        return torch.from_numpy(np.array(array)).to(self._device)

    def _has_room(self) -> bool:
        import torch

        if self._device.type != "cuda":
            return False
        free, total = torch.cuda.mem_get_info(self._device)
        return free > _FREE_SHARE * total
