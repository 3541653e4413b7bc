"""A tagging network with its list of tags."""

from typing import NamedTuple

import numpy as np
import torch

from moseg.tasks.networks.ram.model import Ram


class Tagger(NamedTuple):
    """A network that scores tags, their names, and the score from which each one counts.

    Attributes
    ----------
    network : Ram
        RAM or RAM++.
    names : tuple of str
        In the order of the network's logits.
    thresholds : float64 (num_tags,)
        Least probability of each tag.
    """

    network: Ram
    names: tuple[str, ...]
    thresholds: np.ndarray

    def to(self, device: torch.device | str) -> "Tagger":
        """The same tagger, its network moved to the device."""
        return self._replace(network=self.network.to(device))
