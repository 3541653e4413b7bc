"""RAM and RAM++ from their official checkpoints."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import torch

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.ram.config import RamConfig
from moseg.tasks.networks.ram.model import Ram, RamPlus


class Tagger(NamedTuple):
    """A network that scores tags, their names, and the minimal score of each.

    Attributes
    ----------
    network : Ram
        RAM or RAM++.
    names : tuple of str
        In the order of the network's logits.
    thresholds : float64 (num_tags,)
        Minimal probability of each tag.
    """

    network: Ram
    names: tuple[str, ...]
    thresholds: np.ndarray

    def to(self, device: torch.device | str) -> "Tagger":
        """Return a copy with its network on another device."""
        return self._replace(network=self.network.to(device))


TRAINING_ONLY = ("tag_encoder.", "text_decoder.", "logit_scale")
"""Prefixes of the names of tensors that tagging does not use: the captioner, and the temperature of a training loss."""
DERIVED = (".relative_position_index", ".attn_mask")
"""Suffixes of the names of buffers that depend only on the windows' size and are recomputed."""
OLD_NAME = "vision_multi."
"""Former name of the tagging head in older checkpoints."""
REWEIGHT_SCALE = math.log(1 / 0.07)
"""Log of RAM++'s scale of similarities. The released checkpoint has no such tensor, and the official code then uses its
initial value, which is CLIP's initial temperature."""
TAGS, THRESHOLDS = "tags.txt", "thresholds.txt"


def build_ram(checkpoint: Checkpoint) -> Tagger:
    """Build RAM in evaluation mode, with its tags.

    Parameters
    ----------
    checkpoint : Checkpoint
        The official state dict; documents ``tags.txt`` and ``thresholds.txt``, one a line; the sizes (`RamConfig`)
        if they differ from the published ones.

    Returns
    -------
    Tagger

    Raises
    ------
    InputError
        Tensors do not fit the network, or the documents do not fit its number of tags.
    """
    return _assemble(checkpoint, Ram(checkpoint.sizes(RamConfig())), select_tensors(checkpoint.tensors))


def build_ram_plus(checkpoint: Checkpoint) -> Tagger:
    """Build RAM++ in evaluation mode, with its tags; parameters, result and errors are those of `build_ram`."""
    tensors = {"reweight_scale": torch.tensor(REWEIGHT_SCALE)} | select_tensors(checkpoint.tensors)
    return _assemble(checkpoint, RamPlus(checkpoint.sizes(RamConfig())), tensors)


def select_tensors(tensors: Mapping[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return the tensors that tagging uses, by their present names; unknown ones are kept for the loader to refuse."""
    renamed = {
        "tagging_head." + name.removeprefix(OLD_NAME) if name.startswith(OLD_NAME) else name: tensor
        for name, tensor in tensors.items()
    }
    return {
        name: tensor
        for name, tensor in renamed.items()
        if not name.startswith(TRAINING_ONLY) and not name.endswith(DERIVED)
    }


def _assemble(checkpoint: Checkpoint, network: Ram, tensors: Mapping[str, torch.Tensor]) -> Tagger:
    num_tags = network.config.num_tags
    names = _read_lines(checkpoint, TAGS, num_tags)
    if not all(names) or len(set(names)) != num_tags:
        raise InputError("an empty or repeated tag", where=f"{TAGS} of weights {checkpoint.name}")
    thresholds = _read_thresholds(checkpoint, num_tags)
    return Tagger(load_strictly(network, tensors, checkpoint.name), names, thresholds)


def _read_thresholds(checkpoint: Checkpoint, num_tags: int) -> np.ndarray:
    lines = _read_lines(checkpoint, THRESHOLDS, num_tags)
    try:
        thresholds = np.array([float(line) for line in lines])
    except ValueError as error:
        where = f"{THRESHOLDS} of weights {checkpoint.name}"
        raise InputError("a line that is not a number", where=where, got=str(error)) from error
    if not ((thresholds >= 0) & (thresholds <= 1)).all():
        raise InputError("a threshold outside 0..1", where=f"{THRESHOLDS} of weights {checkpoint.name}")
    return thresholds


def _read_lines(checkpoint: Checkpoint, document: str, count: int) -> tuple[str, ...]:
    lines = tuple(line.strip() for line in checkpoint.document(document).splitlines())
    if len(lines) != count:
        where = f"{document} of weights {checkpoint.name}"
        raise InputError("wrong number of lines", where=where, got=len(lines), expected=f"{count}, one a tag")
    return lines
